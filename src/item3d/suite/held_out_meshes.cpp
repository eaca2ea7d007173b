#include "item3d/suite/held_out_meshes.h"

#include "item3d/core/files.h"
#include "item3d/io/save.h"
#include "item3d/prior/data/shapes/shape_models.h"
#include "item3d/prior/data/shapes/shapes.h"

namespace item3d {

std::map<std::string, std::filesystem::path> save_held_out_meshes(
    const std::filesystem::path& folder) {
    make_output_folder(folder);
    std::map<std::string, std::filesystem::path> files;
    for (const std::string noun : {"airplane", "duck", "rabbit", "sofa", "teapot", "truck"}) {
        files[noun] = folder / (noun + ".glb");
        save_model(files[noun], shape_model(noun, training_variants));
    }
    return files;
}

}  // namespace item3d
