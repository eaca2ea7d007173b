// Benchmark of the renderer's operations. The mesh is a sphere with about as many triangles as a
// scanned object. The environment variable ITEM3D_BENCH_MODEL names a model to use instead.

#include "item3d/io/load.h"
#include "item3d/render/antialias.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/interpolate.h"
#include "item3d/render/render.h"
#include "item3d/render/srgb.h"
#include "item3d/render/textured_materials.h"
#include "item3d/scene/sphere.h"

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdlib>

namespace item3d {
namespace {

struct Scene {
    Geometry geometry;
    std::vector<Camera> cameras;
    EnvironmentLight light;
};

const Scene& scene() {
    static const Scene made = [] {
        const char* path = std::getenv("ITEM3D_BENCH_MODEL");
        const Model model = path != nullptr ? load_model(path) : make_unit_sphere(54, 54);
        at::manual_seed(0);
        return Scene{Geometry::from_model(model), turntable(model.bounds(), 1, 0.3f, 0.6f),
                     prefilter(at::rand({6, 64, 64, 3}))};
    }();
    return made;
}

MaterialSample material(std::int64_t count) {
    MaterialSample sample;
    sample.base_color = at::rand({count, 3});
    sample.orm = at::rand({count, 3});
    sample.normal = at::rand({count, 3}) + 0.5f;
    sample.normal = sample.normal / sample.normal.norm(2, 1, true);
    return sample;
}

void rasterize_view(benchmark::State& state) {
    const int size = static_cast<int>(state.range(0));
    for (auto _ : state)
        benchmark::DoNotOptimize(rasterize(scene().geometry, scene().cameras, size, size));
}
BENCHMARK(rasterize_view)->Arg(64)->Arg(128)->Arg(512)->Unit(benchmark::kMillisecond);

void rasterize_million_triangles(benchmark::State& state) {
    static const Model model = make_unit_sphere(708, 708);
    static const Geometry geometry = Geometry::from_model(model);
    const int size = static_cast<int>(state.range(0));
    const auto cameras = turntable(model.bounds(), 1, 0.3f, 0.6f);
    for (auto _ : state)
        benchmark::DoNotOptimize(rasterize(geometry, cameras, size, size));
}
BENCHMARK(rasterize_million_triangles)->Arg(64)->Arg(512)->Unit(benchmark::kMillisecond);

void interpolate_view(benchmark::State& state) {
    const int size = static_cast<int>(state.range(0));
    const Raster raster = rasterize(scene().geometry, scene().cameras, size, size);
    for (auto _ : state)
        benchmark::DoNotOptimize(interpolate_surface(scene().geometry, raster, scene().cameras));
}
BENCHMARK(interpolate_view)->Arg(64)->Arg(512)->Unit(benchmark::kMillisecond);

void shade_forward(benchmark::State& state) {
    const int size = static_cast<int>(state.range(0));
    const Surface surface = interpolate_surface(
        scene().geometry, rasterize(scene().geometry, scene().cameras, size, size),
        scene().cameras);
    const MaterialSample sample = material(surface.count());
    for (auto _ : state)
        benchmark::DoNotOptimize(shade(surface, sample, scene().light));
}
BENCHMARK(shade_forward)->Arg(64)->Arg(128)->Arg(512)->Unit(benchmark::kMillisecond);

/// Times shading and its gradients with respect to all material inputs. If the second argument is
/// 1, the gradient with respect to the light is included.
void shade_forward_and_backward(benchmark::State& state) {
    const int size = static_cast<int>(state.range(0));
    const Surface surface = interpolate_surface(
        scene().geometry, rasterize(scene().geometry, scene().cameras, size, size),
        scene().cameras);
    MaterialSample sample = material(surface.count());
    for (at::Tensor* tensor : {&sample.base_color, &sample.orm, &sample.normal})
        tensor->set_requires_grad(true);
    EnvironmentLight light = scene().light;
    if (state.range(1) != 0)
        for (at::Tensor& level : light.specular)
            level = level.detach().clone().set_requires_grad(true);
    for (auto _ : state)
        shade(surface, sample, light).sum().backward();
}
BENCHMARK(shade_forward_and_backward)
    ->Args({64, 0})
    ->Args({128, 0})
    ->Args({512, 0})
    ->Args({64, 1})
    ->Args({512, 1})
    ->Unit(benchmark::kMillisecond);

void antialias_view(benchmark::State& state) {
    const int size = static_cast<int>(state.range(0));
    const Raster raster = rasterize(scene().geometry, scene().cameras, size, size);
    const at::Tensor image = at::rand({1, size, size, 3});
    for (auto _ : state)
        benchmark::DoNotOptimize(antialias(image, raster, scene().geometry));
}
BENCHMARK(antialias_view)->Arg(64)->Arg(512)->Unit(benchmark::kMillisecond);

void prefilter_cube(benchmark::State& state) {
    const std::int64_t size = state.range(0);
    at::manual_seed(0);
    at::Tensor cube = at::rand({6, size, size, 3}).set_requires_grad(state.range(1) != 0);
    for (auto _ : state) {
        const EnvironmentLight light = prefilter(cube);
        if (state.range(1) == 0) continue;
        at::Tensor sum = light.diffuse.sum();
        for (const at::Tensor& level : light.specular)
            sum = sum + level.sum();
        sum.backward();
    }
}
BENCHMARK(prefilter_cube)
    ->Args({64, 0})
    ->Args({64, 1})
    ->Args({128, 0})
    ->Args({256, 0})
    ->Args({512, 0})
    ->Args({512, 1})
    ->Unit(benchmark::kMillisecond);

/// Times a preview of a textured model, from triangles to sRGB. Two prefiltered lights alternate.
void preview_under_another_light(benchmark::State& state) {
    const char* path = std::getenv("ITEM3D_BENCH_MODEL");
    const Model model = path != nullptr ? load_model(path) : make_unit_sphere(54, 54);
    const Geometry geometry = Geometry::from_model(model);
    const TexturedMaterials materials(model);
    const auto cameras = turntable(model.bounds(), 1, 0.3f, 0.6f);
    at::manual_seed(0);
    const std::array lights = {prefilter(at::rand({6, 256, 256, 3})),
                               prefilter(at::rand({6, 256, 256, 3}))};
    RenderOptions options;
    options.width = options.height = static_cast<int>(state.range(0));
    options.supersampling = 1;
    const at::NoGradGuard no_grad;
    std::size_t turn = 0;
    for (auto _ : state) {
        const at::Tensor image =
            render(geometry, materials, lights[turn++ % lights.size()], cameras, options);
        benchmark::DoNotOptimize(linear_to_srgb(image.narrow(3, 0, 3).clamp(0, 1)));
    }
}
BENCHMARK(preview_under_another_light)->Arg(512)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace item3d
