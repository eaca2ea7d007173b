// load_image and save_image.
#include "item3d/core/error.h"
#include "item3d/io/image/formats.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"

namespace item3d {

Image load_image(const std::filesystem::path& path) {
    return decode_image(read_bytes(path), path.string()).image;
}

void save_image(const std::filesystem::path& path, const Image& image, int bits_per_channel) {
    std::string extension = path.extension().string();
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    Bytes bytes;
    if (extension == ".png") {
        bytes = encode_png(image, bits_per_channel);
    } else if (extension == ".jpg" || extension == ".jpeg") {
        bytes = encode_jpeg(image);
    } else if (extension == ".hdr") {
        bytes = encode_radiance(image);
    } else if (extension == ".exr") {
        bytes = encode_openexr(image, bits_per_channel);
    } else {
        throw InputError(path.string(),
                         "images are written as .png, .jpg, .hdr or .exr, not '" + extension + "'",
                         "choose one of these extensions");
    }
    write_atomically(path, std::span<const std::uint8_t>(bytes));
}

}  // namespace item3d
