#include "item3d/io/load.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/read.h"
#include "item3d/io/image/formats.h"
#include "item3d/io/obj/read.h"
#include "item3d/io/text.h"

namespace item3d {

Model load_model(const std::filesystem::path& path, const std::string& variant) {
    const Bytes bytes = read_bytes(path);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string extension = to_lower(path.extension().string());
    if (bytes.empty()) {
        throw InputError(path.string(), "a model was expected, the file is empty",
                         "export it again");
    }
    if (text.starts_with("glTF") || extension == ".gltf") return read_gltf(path, bytes, variant);
    if (extension == ".obj" && !variant.empty()) {
        throw InputError(path.string(), "has no variant '" + variant + "', it is an OBJ",
                         "variants are a glTF's");
    }
    if (extension == ".obj") return read_obj(path, bytes);
    if (extension == ".glb") {
        throw InputError(path.string(),
                         "a binary glTF was expected, the file does not start with 'glTF'",
                         "export it again");
    }
    throw InputError(path.string(),
                     "a model was expected (.glb, .gltf or .obj), found '" + extension + "'",
                     "convert it to one of these");
}

Image load_image(const std::filesystem::path& path) {
    return decode_image(read_bytes(path), path.string()).image;
}

}  // namespace item3d
