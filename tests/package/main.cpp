// Program that renders a model with the installed libraries, to test find_package(item3d).
#include <item3d/io/load.h>
#include <item3d/io/load_light.h>
#include <item3d/io/save.h>
#include <item3d/render/image_tensor.h>
#include <item3d/render/render.h>
#include <item3d/render/srgb.h>

int main(int, char** arguments) {
    const item3d::Model model = item3d::load_model(arguments[1]);
    const item3d::Camera camera = item3d::framing_camera(model.bounds(), 0.5f, 0.3f, 0.7f);
    const auto light = item3d::prefilter(item3d::load_light("studio"));
    const item3d::TexturedMaterials materials(model);
    const at::Tensor images = item3d::render(item3d::Geometry::from_model(model), materials, light,
                                             {camera}, {.background = item3d::Vec3(1)});
    item3d::save_image(arguments[2], item3d::to_image(item3d::linear_to_srgb(images[0])));
}
