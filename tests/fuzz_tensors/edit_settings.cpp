#include "item3d/edit/plan.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<0>(data, size, maximum, seed))

/// Reads settings as the defaults of a prior, and as if they came from the command line.
ITEM3D_FUZZ_TARGET(edit_settings, data, size) {
    using namespace item3d;
    const std::string text = fuzz::as_text(data, size);
    fuzz::read_or_refuse([&] {
        const auto folder =
            fuzz::as_files("edit_settings", {"prior.json"}, R"({"defaults": )" + text + "}");
        resolve_plan(folder, {{"from", "a red mug"}, {"to", "a golden mug"}});
    });
    return fuzz::read_or_refuse([&] {
        const auto json = nlohmann::json::parse(text, nullptr, false);
        if (json.is_object()) resolve_plan("/dev/shm/item3d_fuzz_none", json);
    });
}
