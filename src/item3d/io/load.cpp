#include "item3d/io/load.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/gltf/read.h"
#include "item3d/io/image/formats.h"
#include "item3d/io/obj/read.h"
#include "item3d/io/text.h"
#include "item3d/scene/visibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace item3d {

namespace {

Model read_model(const std::filesystem::path& path, const LoadOptions& options) {
    const Bytes bytes = read_bytes(path);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string extension = to_lower(path.extension().string());
    if (bytes.empty()) {
        throw InputError(path.string(), "expected a model, but the file is empty",
                         "export it again");
    }
    if (text.starts_with("glTF") || extension == ".gltf") return read_gltf(path, bytes, options);
    if (extension == ".glb" || extension == ".vrm") {
        throw InputError(path.string(),
                         "expected a binary glTF, but the file does not start with 'glTF'",
                         "export it again");
    }
    if (!options.variant.empty()) {
        throw InputError(path.string(), "has no variant '" + options.variant + "'",
                         "only glTF files have variants");
    }
    if (extension == ".obj") return read_obj(path, bytes, options);
    throw InputError(
        path.string(),
        "expected a model (" + model_extensions_text() + "), found '" + extension + "'",
        "convert it to one of these");
}

/// Throws InputError for a model whose size is beyond what the renderer computes in float32.
void check_size(const Model& model, const std::filesystem::path& path) {
    constexpr float smallest = 1e-7f, largest = 1e15f;
    const std::array<Vec3, 2> bounds = model.bounds();
    const Vec3 sides = bounds[1] - bounds[0];
    const float side = std::max({sides.x, sides.y, sides.z});
    if (side == 0 || (side >= smallest && side <= largest)) return;
    throw InputError(path.string(),
                     fmt::format("the model is {:.2g} units across; expected a size between {:g} "
                                 "and {:g}",
                                 side, smallest, largest),
                     "scale it in a modelling program");
}

}  // namespace

bool is_model_file(const std::filesystem::path& path) {
    return std::find(model_extensions.begin(), model_extensions.end(),
                     to_lower(path.extension().string())) != model_extensions.end();
}

std::string model_extensions_text() {
    std::string text;
    for (const std::string_view extension : model_extensions) {
        if (!text.empty()) text += extension == model_extensions.back() ? " or " : ", ";
        text += extension;
    }
    return text;
}

Model load_model(const std::filesystem::path& path, const LoadOptions& options) {
    for (const std::filesystem::path& folder : options.texture_folders) {
        if (std::error_code too_long; !std::filesystem::is_directory(folder, too_long))
            throw InputError("--textures " + folder.string(), "is not a folder", "check the path");
    }
    Model model = read_model(path, options);
    check_size(model, path);
    if (!is_visible(model)) {
        warn(path.string() +
             ": the model is invisible: it is fully transparent, or its triangles have no area");
    }
    return model;
}

Image load_image(const std::filesystem::path& path) {
    return decode_image(read_bytes(path), path.string()).image;
}

}  // namespace item3d
