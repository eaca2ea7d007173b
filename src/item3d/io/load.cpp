#include "item3d/io/load.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/gltf/read.h"
#include "item3d/io/image/formats.h"
#include "item3d/io/obj/read.h"
#include "item3d/io/text.h"
#include "item3d/scene/visibility.h"

namespace item3d {

namespace {

Model read_model(const std::filesystem::path& path, const LoadOptions& options) {
    const Bytes bytes = read_bytes(path);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string extension = to_lower(path.extension().string());
    if (bytes.empty()) {
        throw InputError(path.string(), "a model was expected, the file is empty",
                         "export it again");
    }
    if (text.starts_with("glTF") || extension == ".gltf") return read_gltf(path, bytes, options);
    if (extension == ".obj" && !options.variant.empty()) {
        throw InputError(path.string(), "has no variant '" + options.variant + "', it is an OBJ",
                         "variants are a glTF's");
    }
    if (extension == ".obj") return read_obj(path, bytes, options);
    if (extension == ".glb") {
        throw InputError(path.string(),
                         "a binary glTF was expected, the file does not start with 'glTF'",
                         "export it again");
    }
    throw InputError(path.string(),
                     "a model was expected (.glb, .gltf or .obj), found '" + extension + "'",
                     "convert it to one of these");
}

}  // namespace

Model load_model(const std::filesystem::path& path, const LoadOptions& options) {
    for (const std::filesystem::path& folder : options.texture_folders) {
        if (!std::filesystem::is_directory(folder))
            throw InputError("--textures " + folder.string(), "is no folder", "check the path");
    }
    Model model = read_model(path, options);
    if (!is_visible(model)) {
        warn(path.string() +
             ": nothing of it is seen: it is wholly transparent, or its triangles have no area");
    }
    return model;
}

Image load_image(const std::filesystem::path& path) {
    return decode_image(read_bytes(path), path.string()).image;
}

}  // namespace item3d
