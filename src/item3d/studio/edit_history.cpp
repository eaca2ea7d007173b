#include "item3d/studio/edit_history.h"

#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/hub/find_prior.h"

#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::vector<EditCost> last_costs(StudioStore& store, const StudioFolders& folders) {
    constexpr std::size_t maximum = 10;
    std::vector<EditCost> costs;
    const std::vector<StudioResult> done = store.results_in(ResultState::done);
    for (auto result = done.rbegin(); result != done.rend() && costs.size() < maximum; ++result) {
        const fs::path file = folders.result(result->project, result->id) / "edit.json";
        if (result->kind != "edit" || !fs::exists(file)) continue;
        if (const auto cost = edit_cost(parse_json(read_text(file)))) costs.push_back(*cost);
    }
    return costs;
}

}  // namespace

EditHistory read_edit_history(StudioStore& store, const StudioFolders& folders) {
    const Json prior = parse_json_or_throw(read_text(find_prior("") / "prior.json"));
    return {prior.value("defaults", Json::object()), last_costs(store, folders),
            static_cast<int>(std::thread::hardware_concurrency())};
}

}  // namespace item3d
