// Tests that images for the prior and images for the user show the same surface in the same light.
#include "item3d/edit/optimize/render_view.h"

#include "item3d/edit/optimize/initial_state.h"
#include "tests/support/edit.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;

class RenderView : public testing::EditTest {};

TEST_F(RenderView, ShowsWhatTheModelEmitsOnce) {
    const Model cube = load_model(folder_ / "cube.glb");
    Model shining;  // without the source file, whose materials would be kept
    shining.primitives = cube.primitives;
    shining.materials = cube.materials;
    shining.textures = cube.textures;
    shining.materials[0].emissive_factor = Vec3(0.1f, 0.2f, 0.05f);
    save_model(folder_ / "cube.glb", shining);
    const EditRequest edit = request("out", 1);
    fs::create_directories(edit.output);
    const EditScene scene = load_scene(edit);
    EditState state = begin_or_resume(edit, scene);
    const std::vector<Camera> cameras = field_cameras(scene, 1);
    const EnvironmentLight& light = scene.lights->front();
    ViewOptions options;
    options.light = &light;
    const GBuffer gbuffer = rasterize_views(scene, edit.plan, cameras);
    ASSERT_TRUE(gbuffer.own.sample.emissive.defined());
    const at::NoGradGuard no_grad;
    const at::Tensor for_prior =
        render_view(scene, edit.plan, state.field, gbuffer, options).images[0].permute({1, 2, 0});
    const int size = static_cast<int>(for_prior.size(0));
    const at::Tensor for_people = draw_field(scene, state.field, light, cameras, size)[0];
    const auto middle = [&](const at::Tensor& image) {  // only pixels of the cube
        return image.narrow(0, 3 * size / 8, size / 4).narrow(1, 3 * size / 8, size / 4);
    };
    // The two differ slightly, because only one is supersampled.
    EXPECT_LT((middle(for_prior) - middle(for_people)).abs().mean().item<float>(), 0.01f);
}

}  // namespace
}  // namespace item3d
