#include "apps/item3d/bench/bench_render.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/field/neural_texture.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/antialias.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/scatter.h"
#include "item3d/render/srgb.h"
#include "item3d/render/texture.h"
#include "item3d/scene/sphere.h"

#include <torch/cuda.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

namespace item3d {
namespace {

constexpr int light_cube_size = 64;

/// Timer that runs a function several times and takes the median.
class Stopwatch {
  public:
    Stopwatch(at::Device device, int repeats) : device_(device), repeats_(repeats) {}

    /// prepare: function called before each run, outside of the measured time.
    double median_ms(const std::function<void()>& run,
                     const std::function<void()>& prepare = nullptr) const {
        std::vector<double> taken;
        // The first run does not count, because it fills tables and caches, and on a GPU it
        // compiles kernels.
        for (int i = 0; i <= repeats_; ++i) {
            if (interrupted()) throw Interrupted("nothing was written");
            if (prepare) prepare();
            wait();
            const auto start = std::chrono::steady_clock::now();
            run();
            wait();
            const std::chrono::duration<double, std::milli> time =
                std::chrono::steady_clock::now() - start;
            if (i > 0) taken.push_back(time.count());
        }
        std::sort(taken.begin(), taken.end());
        const std::size_t middle = taken.size() / 2;
        return taken.size() % 2 == 1 ? taken[middle] : 0.5 * (taken[middle - 1] + taken[middle]);
    }

    /// Times a stage. forward returns one tensor. leaves: tensors for which the gradient is
    /// computed.
    StageTime stage(const std::string& name, const std::function<at::Tensor()>& forward,
                    const std::vector<at::Tensor>& leaves) const {
        StageTime time;
        time.stage = name;
        {
            const at::NoGradGuard no_gradients;
            time.forward_ms = median_ms([&] { forward(); });
        }
        at::Tensor out, seed;
        time.backward_ms = median_ms([&] { out.backward(seed); },
                                     [&] {
                                         forget(leaves);
                                         out = forward();
                                         seed = at::ones_like(out);
                                     });
        forget(leaves);
        return time;
    }

    static void forget(const std::vector<at::Tensor>& leaves) {
        for (const at::Tensor& leaf : leaves)
            leaf.mutable_grad() = at::Tensor();
    }

  private:
    void wait() const {
        if (device_.is_cuda()) torch::cuda::synchronize();
    }

    at::Device device_;
    int repeats_;
};

at::Tensor leaf(const at::Tensor& value) {
    return value.detach().clone().set_requires_grad(true);
}

/// Returns the base colour texture that covers the most triangles, as linear RGB [H, W, 3]. Returns
/// a synthetic texture if there is none.
at::Tensor base_color_texture(const Model& model) {
    std::vector<std::size_t> triangles(model.materials.size(), 0);
    for (const Primitive& primitive : model.primitives)
        triangles[static_cast<std::size_t>(primitive.material)] += primitive.indices.size() / 3;
    int chosen = -1;
    std::size_t maximum = 0;
    for (std::size_t m = 0; m < triangles.size(); ++m) {
        const int texture = model.materials[m].base_color_texture;
        if (texture < 0 || triangles[m] <= maximum) continue;
        maximum = triangles[m];
        chosen = texture;
    }
    if (chosen >= 0) {
        const at::Tensor texels = to_tensor(model.textures[static_cast<std::size_t>(chosen)].image);
        return srgb_to_linear(texels.size(2) >= 3 ? texels.narrow(2, 0, 3)
                                                  : texels.narrow(2, 0, 1).expand(
                                                        {texels.size(0), texels.size(1), 3}));
    }
    constexpr std::int64_t side = 1024;
    return at::linspace(0.05, 0.95, side * side * 3).reshape({side, side, 3});
}

/// Forward and backward passes over one view, as in an edit and in `item3d render`.
struct View {
    Geometry geometry;
    std::vector<Camera> cameras;
    ImageSize size;
    EnvironmentLight light;
    at::Tensor texture;  ///< [H, W, 3], a leaf
    NeuralTexture field{nullptr};

    Raster visible() const { return rasterize(geometry, cameras, size.width, size.height); }

    at::Tensor composed(const at::Tensor& radiance, const Surface& surface,
                        const Raster& raster) const {
        const at::Tensor values =
            at::cat({radiance, at::ones({radiance.size(0), 1}, radiance.options())}, 1);
        return antialias(scatter(values, surface, raster, at::zeros({4}, radiance.options())),
                         raster, geometry);
    }

    at::Tensor image(const std::function<MaterialSample(const Surface&)>& material) const {
        const Raster raster = visible();
        const Surface surface = interpolate_surface(geometry, raster, cameras);
        return composed(shade(surface, material(surface), light), surface, raster);
    }

    MaterialSample textured(const Surface& surface) const {
        MaterialSample sample;
        sample.base_color = sample_texture(texture, surface.uv);
        sample.orm =
            at::tensor({1.0f, 0.5f, 0.0f}).to(texture.device()).expand({surface.count(), 3});
        return sample;
    }

    at::Tensor filtered(const Surface& surface, const at::Tensor& footprints) const {
        return sample_texture(texture_pyramid(texture), surface.uv, footprints);
    }

    std::vector<at::Tensor> field_leaves() const {
        std::vector<at::Tensor> leaves = field->network_parameters();
        leaves.push_back(field->table());
        return leaves;
    }
};

/// Returns all outputs of the field as one tensor.
at::Tensor joined(const MaterialSample& sample) {
    return at::cat({sample.base_color, sample.orm, sample.normal}, 1);
}

void time_stages(View& view, const Stopwatch& watch, std::vector<StageTime>& stages) {
    const Raster raster = view.visible();
    const Surface surface = interpolate_surface(view.geometry, raster, view.cameras);
    const at::Tensor still = view.geometry.positions;

    // These two stages are also measured with gradients of vertices, which an edit does not need.
    view.geometry.positions = leaf(still);
    stages.push_back(watch.stage("rasterise", [&] { return view.visible().positions_clip; },
                                 {view.geometry.positions}));
    Raster moving = view.visible();
    moving.positions_clip = leaf(moving.positions_clip);
    stages.push_back(watch.stage("interpolate",
                                 [&] {
                                     const Surface at =
                                         interpolate_surface(view.geometry, moving, view.cameras);
                                     return at::cat({at.position, at.normal}, 1);
                                 },
                                 {view.geometry.positions, moving.positions_clip}));
    view.geometry.positions = still;

    stages.push_back(watch.stage("sample textures",
                                 [&] { return sample_texture(view.texture, surface.uv); },
                                 {view.texture}));
    const at::Tensor footprints = uv_footprints(view.geometry, raster, surface);
    stages.push_back(watch.stage("sample with mip levels",
                                 [&] { return view.filtered(surface, footprints); },
                                 {view.texture}));
    const at::Tensor positions = surface.position.detach();
    stages.push_back(watch.stage(
        "neural texture", [&] { return joined(view.field->forward(positions)); },
        view.field_leaves()));

    MaterialSample material;
    {
        const at::NoGradGuard no_gradients;
        material = view.textured(surface);
    }
    material.base_color = leaf(material.base_color);
    material.orm = leaf(material.orm);
    stages.push_back(watch.stage("shade", [&] { return shade(surface, material, view.light); },
                                 {material.base_color, material.orm}));
    const at::Tensor radiance = leaf(shade(surface, material, view.light));
    stages.push_back(watch.stage("scatter and antialias",
                                 [&] { return view.composed(radiance, surface, raster); },
                                 {radiance}));
}

}  // namespace

Camera BenchScene::camera(ImageSize size) const {
    return default_view(model, static_cast<float>(size.width) / static_cast<float>(size.height));
}

BenchScene sphere_scene(int squares) {
    BenchScene scene;
    scene.name = "sphere";
    scene.model = make_unit_sphere(squares, squares);
    return scene;
}

RenderTimes time_render(const BenchScene& scene, const Image& light, ImageSize size,
                        at::Device device, int repeats) {
    const Stopwatch watch(device, repeats);
    View view;
    view.geometry = Geometry::from_model(scene.model, device);
    view.cameras = {scene.camera(size)};
    view.size = size;
    view.light = prefilter(light, light_cube_size, device);
    view.texture = leaf(base_color_texture(scene.model).to(device));
    NeuralTextureOptions field_options;
    field_options.bounds = scene.model.bounds();
    view.field = NeuralTexture(field_options);
    view.field->to(device);

    RenderTimes times;
    {
        const at::NoGradGuard no_gradients;
        times.covered_pixels =
            interpolate_surface(view.geometry, view.visible(), view.cameras).count();
    }
    const auto from_texture = [&](const Surface& surface) { return view.textured(surface); };
    const auto from_field = [&](const Surface& surface) {
        return view.field->forward(surface.position);
    };
    const auto forward = [&](const auto& material) {
        const at::NoGradGuard no_gradients;
        return watch.median_ms([&] { view.image(material); });
    };
    const auto forward_backward = [&](const auto& material, const std::vector<at::Tensor>& leaves) {
        return watch.median_ms([&] { view.image(material).square().mean().backward(); },
                               [&] { Stopwatch::forget(leaves); });
    };
    times.forward_ms = forward(from_texture);
    times.forward_backward_ms = forward_backward(from_texture, {view.texture});
    times.neural_forward_ms = forward(from_field);
    times.neural_forward_backward_ms = forward_backward(from_field, view.field_leaves());
    time_stages(view, watch, times.stages);
    return times;
}

StageTime time_prefilter(int size, int repeats) {
    const at::Tensor cube =
        leaf(at::linspace(0.1, 1.0, std::int64_t{6} * size * size * 3).reshape({6, size, size, 3}));
    const auto forward = [&] {
        const EnvironmentLight light = prefilter(cube);
        std::vector<at::Tensor> maps{light.diffuse.flatten()};
        for (const at::Tensor& level : light.specular)
            maps.push_back(level.flatten());
        return at::cat(maps);
    };
    return Stopwatch(at::kCPU, repeats).stage("prefilter the light", forward, {cube});
}

}  // namespace item3d
