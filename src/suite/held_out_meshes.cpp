#include "item3d/suite/held_out_meshes.h"

#include "item3d/core/files.h"
#include "item3d/prior/polygonize.h"
#include "item3d/prior/shapes.h"
#include "item3d/scene/io/save.h"

namespace item3d {

std::map<std::string, std::filesystem::path> save_held_out_meshes(
    const std::filesystem::path& folder) {
    constexpr int cells_a_side = 96;
    make_output_folder(folder);
    std::map<std::string, std::filesystem::path> files;
    for (const std::string noun : {"airplane", "duck", "rabbit", "sofa", "teapot", "truck"}) {
        const Shape shape = make_shape(noun, training_variants);
        const auto distance = [&](const Vec3& point) { return shape.distance(point); };
        Model model;
        model.materials.resize(1);
        model.primitives.push_back(polygonize(distance, cells_a_side).primitive);
        files[noun] = folder / (noun + ".glb");
        save_model(files[noun], model);
    }
    return files;
}

}  // namespace item3d
