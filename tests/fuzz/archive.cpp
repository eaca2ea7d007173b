#include "item3d/studio/archive.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(archive, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const auto file = fuzz::as_file("model.zip", fuzz::as_text(data, size));
        const auto folder = file.parent_path() / "unpacked";
        std::filesystem::remove_all(folder);
        std::filesystem::create_directories(folder);
        unpack_model(file, folder, {.entries = 50, .bytes = 1 << 20});
    });
}
