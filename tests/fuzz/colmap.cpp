#include "item3d/reconstruct/dataset/colmap.h"

#include "tests/fuzz/fuzz.h"

/// Reads a COLMAP model. If the first byte is even, the input holds cameras.txt and images.txt.
/// Otherwise it holds the length of cameras.bin in two bytes, cameras.bin, and images.bin.
ITEM3D_FUZZ_TARGET(colmap, data, size) {
    using namespace item3d;
    if (size < 3) return 0;
    return fuzz::read_or_refuse([&] {
        const std::string content = fuzz::as_text(data + 1, size - 1);
        std::filesystem::path folder;
        if (data[0] % 2 == 0) {
            folder = fuzz::as_files("colmap_text", {"cameras.txt", "images.txt"}, content);
        } else {
            const std::size_t length = 256u * data[2] + data[1];
            folder = fuzz::as_files("colmap_binary", {}, "");
            std::ofstream(folder / "cameras.bin", std::ios::binary) << content.substr(2, length);
            std::ofstream(folder / "images.bin", std::ios::binary)
                << content.substr(std::min(2 + length, content.size()));
        }
        if (!is_colmap_model(folder)) return;
        read_colmap(folder, folder / "images");
        count_colmap_images(folder);
    });
}
