#include "item3d/io/save.h"

#include "item3d/core/error.h"
#include "item3d/io/readers.h"
#include "item3d/io/text.h"

namespace item3d {

void save_model(const std::filesystem::path& path, const Model& model, const ModelEdit& edit) {
    const std::string extension = to_lower(path.extension().string());
    if (extension == ".glb" || extension == ".gltf") {
        write_gltf(path, model, edit);
    } else if (extension == ".obj") {
        write_obj(path, model, edit);
    } else {
        throw InputError(path.string(),
                         "models are written as .glb, .gltf or .obj, not '" + extension + "'",
                         "choose one of these extensions");
    }
}

}  // namespace item3d
