#include "item3d/suite/held_out_meshes.h"

#include "item3d/core/files.h"
#include "item3d/io/save.h"
#include "item3d/prior/data/shapes/shape_models.h"
#include "item3d/prior/data/shapes/shapes.h"

namespace item3d {

std::vector<std::string> held_out_nouns() {
    return {"airplane", "duck", "rabbit", "sofa", "teapot", "truck"};
}

std::filesystem::path save_held_out_mesh(const std::filesystem::path& folder,
                                         const std::string& noun) {
    make_output_folder(folder);
    const std::filesystem::path file = folder / (noun + ".glb");
    save_model(file, shape_model(noun, training_variants));
    return file;
}

std::map<std::string, std::filesystem::path> save_held_out_meshes(
    const std::filesystem::path& folder) {
    std::map<std::string, std::filesystem::path> files;
    for (const std::string& noun : held_out_nouns())
        files[noun] = save_held_out_mesh(folder, noun);
    return files;
}

}  // namespace item3d
