// Tests of the same operations on the CPU and on a CUDA device. Without a device these comparisons
// are skipped, and the device's algorithms for sums and drawing are checked on the CPU.
#include "item3d/core/error.h"
#include "item3d/render/antialias.h"
#include "item3d/render/cuda/module.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/prefilter/equirectangular.h"
#include "item3d/render/render.h"
#include "item3d/render/scatter.h"
#include "item3d/render/texture.h"
#include "item3d/render/textured_materials.h"
#include "item3d/render/topology.h"
#include "tests/support/render.h"

#include <ATen/Context.h>
#include <dlfcn.h>

#include <cstdlib>
#include <cstring>
#include <limits>

namespace item3d {
namespace {

using testing::front_camera;

/// Must be queried first: LibTorch looks for devices only once.
const bool has_device = cuda::cuda_available();

#define SKIP_WITHOUT_DEVICE() \
    if (!has_device)          \
    GTEST_SKIP() << "no CUDA device, or no libtorch_cuda.so: nothing to compare the CPU with"

/// A sphere of two overlapping layers, and cameras that look at it.
struct Scene {
    Geometry geometry;
    std::vector<Camera> cameras{front_camera(3), front_camera(2.2f, 0.6f)};
    int width = 96, height = 80;
};

Scene make_scene() {
    Model model = make_unit_sphere(24, 48);
    Primitive inner = model.primitives[0];
    for (Vec3& position : inner.positions)
        position = position * 0.7f + Vec3(0.5f, 0.1f, 0.4f);
    model.primitives.push_back(inner);
    Scene scene;
    scene.geometry = Geometry::from_model(model);
    scene.geometry.neighbours =
        triangle_neighbours(scene.geometry.positions, scene.geometry.triangles);
    return scene;
}

Geometry on_device(const Geometry& geometry) {
    Geometry moved = geometry;
    for (at::Tensor* tensor :
         {&moved.positions, &moved.normals, &moved.tangents, &moved.uvs, &moved.colors,
          &moved.triangles, &moved.triangle_material, &moved.triangle_primitive, &moved.neighbours})
        if (tensor->defined()) *tensor = tensor->to(at::kCUDA);
    return moved;
}

/// Returns the maximum difference relative to the largest value.
double relative_error(const at::Tensor& found, const at::Tensor& expected) {
    const at::Tensor difference = (found.cpu().to(at::kDouble) - expected).abs().max();
    return difference.item<double>() / std::max(1e-12, expected.abs().max().item<double>());
}

TEST(CudaModule, TableIsComplete) {
#if !defined(ITEM3D_CUDA_MODULE)
    GTEST_SKIP() << "built with ITEM3D_CUDA=OFF";
#else
    void* module = dlopen(ITEM3D_CUDA_MODULE, RTLD_NOW | RTLD_LOCAL);
    ASSERT_NE(module, nullptr) << dlerror();
    const auto function =
        reinterpret_cast<const cuda::RenderTable* (*)()>(dlsym(module, "item3d_cuda_render"));
    ASSERT_NE(function, nullptr) << dlerror();
    const cuda::RenderTable* table = function();
    EXPECT_EQ(table->header.version, cuda::table_version);
    ASSERT_EQ(table->header.size, sizeof(cuda::RenderTable));
    EXPECT_NE(table->error_text, nullptr);
#define EXPECT_ENTRY(entry, ...) EXPECT_NE(table->entry, nullptr);
    ITEM3D_RENDER_KERNELS(EXPECT_ENTRY)
#undef EXPECT_ENTRY
    // The module beside the program is opened as the renderer opens it.
    EXPECT_EQ(cuda::render_table().header.size, sizeof(cuda::RenderTable));
    EXPECT_THROW(cuda::find_table("item3d_cuda_nothing", 8), ResourceError);
    EXPECT_THROW(cuda::find_table("item3d_cuda_render", 8), ResourceError);
    if (cuda::cuda_available()) return;
    // Without a device, a launch returns an error.
    const int error = table->finish_sums(FinishSumsParameters{}, 1, nullptr);
    EXPECT_NE(error, 0);
    EXPECT_GT(std::strlen(table->error_text(error)), 5u);
#endif
}

/// The terms have very different magnitudes. In any order, two passes give the same bytes, namely
/// those of the sum in double.
TEST(Accumulator, TwoPassesDoNotDependOnTheOrder) {
    constexpr std::int64_t terms = 5000;
    at::manual_seed(5);
    const at::Tensor values =
        (at::randn({terms}) * at::pow(10.0f, 6 * at::randn({terms}))).contiguous();
    const auto sum = [&](bool backwards) {
        std::uint32_t largest = 0;
        unsigned long long fixed = 0;
        Accumulator accumulator;
        accumulator.bits = accumulator_bits(terms);
        accumulator.largest = &largest;
        for (int pass = 0; pass < 2; ++pass) {
            for (std::int64_t i = 0; i < terms; ++i)
                accumulator.add(0, values.data_ptr<float>()[backwards ? terms - 1 - i : i]);
            accumulator.fixed = &fixed;
        }
        float result = 0;
        finish_sum({&largest, &fixed, accumulator.bits, &result}, 0);
        return result;
    };
    EXPECT_EQ(sum(false), sum(true));
    EXPECT_FLOAT_EQ(sum(false), static_cast<float>(values.to(at::kDouble).sum().item<double>()));

    // The announced number of terms, each as large as this float, causes no overflow.
    const float largest_float = std::numeric_limits<float>::max() / 4096;
    std::uint32_t largest = 0;
    unsigned long long fixed = 0;
    Accumulator accumulator;
    accumulator.bits = accumulator_bits(4096);
    accumulator.largest = &largest;
    accumulator.add(0, largest_float);
    accumulator.fixed = &fixed;
    for (int i = 0; i < 4096; ++i)
        accumulator.add(0, largest_float);
    float result = 0;
    finish_sum({&largest, &fixed, accumulator.bits, &result}, 0);
    EXPECT_FLOAT_EQ(result, 4096 * largest_float);

    accumulator.fixed = nullptr;
    accumulator.add(0, std::numeric_limits<float>::quiet_NaN());
    finish_sum({&largest, &fixed, accumulator.bits, &result}, 0);
    EXPECT_TRUE(std::isnan(result));
}

/// The device's kernels draw in any order, and must give the CPU's ordered result to the last bit.
TEST(CudaKernels, KeysGiveTheCpusRaster) {
    const Scene scene = make_scene();
    for (const bool second_layer : {false, true}) {
        at::Tensor behind;
        if (second_layer) {
            const at::Tensor depth =
                rasterize(scene.geometry, scene.cameras, scene.width, scene.height).depth;
            behind = at::where(depth > 0, depth, at::full_like(depth, 1e30f));
        }
        const Raster expected =
            rasterize(scene.geometry, scene.cameras, scene.width, scene.height, behind);
        ASSERT_GT((expected.triangle >= 0).sum().item<int>(), 1000);

        const std::int64_t triangles = scene.geometry.triangles.size(0);
        std::vector<kernels::PixelBox> boxes(static_cast<std::size_t>(2 * triangles));
        at::Tensor barycentrics = at::full_like(expected.barycentrics, 7);
        at::Tensor depth = at::full_like(expected.depth, 7);
        at::Tensor triangle = at::full_like(expected.triangle, 7);
        std::vector<unsigned long long> keys(static_cast<std::size_t>(depth.numel()), 0);
        const kernels::KeyedRasterParameters keyed{
            {expected.positions_clip.const_data_ptr<float>(),
             scene.geometry.triangles.const_data_ptr<std::int32_t>(), boxes.data(),
             scene.geometry.positions.size(0), triangles, scene.width, scene.height,
             barycentrics.data_ptr<float>(), depth.data_ptr<float>(),
             triangle.data_ptr<std::int32_t>(),
             behind.defined() ? behind.const_data_ptr<float>() : nullptr},
            keys.data(),
            2,
            3};
        for (std::int64_t i = 0; i < 2 * triangles; ++i)
            kernels::bound_triangle(keyed.raster, i / keyed.raster.triangle_count,
                                    i % keyed.raster.triangle_count);
        for (std::int64_t i = 2 * triangles * keyed.bands; i-- > 0;)
            kernels::rasterize_keys(keyed, i);
        for (std::int64_t i = 0; i < depth.numel(); ++i)
            kernels::resolve_key(keyed, i);
        EXPECT_TRUE(at::equal(triangle, expected.triangle));
        EXPECT_TRUE(at::equal(depth, expected.depth));
        EXPECT_TRUE(at::equal(barycentrics, expected.barycentrics));
    }
}

/// Blending by gathering gives the same as a list of crossings, to the last bit.
TEST(CudaKernels, GatheredBlendsAreTheCpus) {
    const Scene scene = make_scene();
    const Raster raster = rasterize(scene.geometry, scene.cameras, scene.width, scene.height);
    at::manual_seed(2);
    const at::Tensor image = at::rand({2, scene.height, scene.width, 3}).set_requires_grad(true);
    const at::Tensor weights = at::randn({2, scene.height, scene.width, 3});
    Raster leaf = raster;
    leaf.positions_clip = raster.positions_clip.detach().set_requires_grad(true);
    Geometry geometry = scene.geometry;
    const at::Tensor expected = antialias(image, leaf, geometry);
    ASSERT_GT((expected - image).abs().gt(1e-3f).sum().item<int>(), 200);
    (expected * weights).sum().backward();

    at::Tensor blended = at::empty_like(image), by_image = at::empty_like(image);
    at::Tensor by_clip = at::zeros_like(raster.positions_clip);
    kernels::BlendParameters p{};
    p.raster = {raster.positions_clip.const_data_ptr<float>(),
                geometry.triangles.const_data_ptr<std::int32_t>(),
                geometry.neighbours.const_data_ptr<std::int32_t>(),
                raster.triangle.const_data_ptr<std::int32_t>(),
                raster.depth.const_data_ptr<float>(),
                geometry.positions.size(0),
                scene.width,
                scene.height};
    p.image = image.const_data_ptr<float>();
    p.channels = 3;
    p.blended = blended.data_ptr<float>();
    p.gradient = weights.const_data_ptr<float>();
    p.image_gradient = by_image.data_ptr<float>();
    p.clip_gradient.values = by_clip.data_ptr<float>();
    for (std::int64_t pixel = 0; pixel < raster.triangle.numel(); ++pixel) {
        kernels::blend_pixel(p, pixel);
        kernels::blend_pixel_backward(p, pixel);
    }
    EXPECT_TRUE(at::equal(blended, expected));
    EXPECT_TRUE(at::equal(by_image, image.grad()));
    EXPECT_TRUE(at::equal(by_clip, leaf.positions_clip.grad()));
}

/// Many pixels look up the same texels. Gradients are summed in two passes, from the last pixel to
/// the first.
TEST(CudaKernels, TexelGradientsInTwoPassesAreTheCpus) {
    constexpr std::int64_t count = 600;
    at::manual_seed(6);
    const at::Tensor uv = 3 * at::rand({count, 2}) - 1;
    const at::Tensor footprint = 0.2f * at::randn({count, 4});
    const at::Tensor weights = at::randn({count, 3});
    std::vector<at::Tensor> levels = texture_pyramid(at::rand({16, 8, 3}));
    for (at::Tensor& level : levels)
        level.set_requires_grad(true);
    (sample_texture(levels, uv, footprint) * weights).sum().backward();

    kernels::TextureParameters p{};
    p.level_count = static_cast<int>(levels.size());
    p.channels = 3;
    p.uv = uv.const_data_ptr<float>();
    p.footprint = footprint.const_data_ptr<float>();
    std::vector<at::Tensor> expected;
    std::int64_t total = 0;
    for (std::size_t i = 0; i < levels.size(); ++i) {
        p.levels[i] = {levels[i].const_data_ptr<float>(), static_cast<int>(levels[i].size(0)),
                       static_cast<int>(levels[i].size(1)), total};
        total += levels[i].numel();
        expected.push_back(levels[i].grad().flatten());
    }
    std::vector<std::uint32_t> largest(static_cast<std::size_t>(total), 0);
    std::vector<unsigned long long> fixed(static_cast<std::size_t>(total), 0);
    Accumulator accumulator;
    accumulator.bits = accumulator_bits(4 * kernels::max_texture_probes * count);
    accumulator.largest = largest.data();
    for (int pass = 0; pass < 2; ++pass) {
        for (std::int64_t i = count; i-- > 0;)
            kernels::texture_backward(p, i, weights.const_data_ptr<float>(), accumulator);
        accumulator.fixed = fixed.data();
    }
    const at::Tensor found = at::empty({total});
    for (std::int64_t i = 0; i < total; ++i)
        finish_sum({largest.data(), fixed.data(), accumulator.bits, found.data_ptr<float>()}, i);
    EXPECT_LT(relative_error(found, at::cat(expected)), 1e-5);
}

/// RAII guard that sets LibTorch's deterministic mode.
struct Deterministic {
    explicit Deterministic(bool on) {
        // LibTorch requires this for matrix products in deterministic mode.
        setenv("CUBLAS_WORKSPACE_CONFIG", ":4096:8", 0);
        at::globalContext().setDeterministicAlgorithms(on, false);
    }
    ~Deterministic() { at::globalContext().setDeterministicAlgorithms(false, false); }
};

TEST(CudaDevice, RasterIsTheCpus) {
    SKIP_WITHOUT_DEVICE();
    const Scene scene = make_scene();
    const Raster cpu = rasterize(scene.geometry, scene.cameras, scene.width, scene.height);
    const Raster device =
        rasterize(on_device(scene.geometry), scene.cameras, scene.width, scene.height);
    EXPECT_TRUE(at::equal(device.triangle.cpu(), cpu.triangle));
    EXPECT_LT(relative_error(device.depth, cpu.depth), 1e-4);
    EXPECT_LT(relative_error(device.barycentrics, cpu.barycentrics), 1e-4);
}

/// Result of all stages from vertices to antialiased images, with the gradients of all inputs that
/// have one.
struct Rendered {
    at::Tensor image;
    std::vector<at::Tensor> gradients;
};

Rendered render_scene(const Scene& scene, at::Device device) {
    at::manual_seed(9);
    const at::Tensor weights = at::randn({2, scene.height, scene.width, 3}).to(device);
    std::vector<at::Tensor> light_maps{testing::smooth_cube(16), testing::smooth_cube(32, 4),
                                       testing::smooth_cube(16, 5), testing::smooth_cube(16, 6),
                                       testing::smooth_cube(16, 7)};
    Geometry geometry = device.is_cuda() ? on_device(scene.geometry) : scene.geometry;
    const auto leaf = [&](const at::Tensor& tensor) {
        return tensor.detach().clone().to(device).set_requires_grad(true);
    };
    geometry.positions = leaf(geometry.positions);
    geometry.normals = leaf(geometry.normals);
    for (at::Tensor& map : light_maps)
        map = leaf(map);
    const Raster raster = rasterize(geometry, scene.cameras, scene.width, scene.height);
    const Surface surface = interpolate_surface(geometry, raster, scene.cameras);
    at::manual_seed(10);
    const std::int64_t count = surface.count();
    MaterialSample material;
    material.base_color = leaf(at::rand({count, 3}));
    material.orm = leaf(at::rand({count, 3}) * 0.9f + 0.05f);
    material.normal =
        leaf(testing::unit_rows(at::randn({count, 3}) * 0.2f + at::tensor({0.0f, 0.0f, 1.0f})));
    const EnvironmentLight light{
        light_maps[0], {light_maps.begin() + 1, light_maps.end()}, {0.1f, 0.25f, 0.5f, 0.9f}};
    const at::Tensor radiance = shade(surface, material, light);
    const at::Tensor background = leaf(at::rand({3}));
    const at::Tensor image = scatter(radiance, surface, raster, background);
    const at::Tensor smooth = antialias(image, raster, geometry);
    (smooth * weights).sum().backward();
    Rendered rendered{smooth.detach().cpu(), {}};
    for (const at::Tensor& input : {geometry.positions, geometry.normals, material.base_color,
                                    material.orm, material.normal, background})
        rendered.gradients.push_back(input.grad().cpu());
    for (const at::Tensor& map : light_maps)
        rendered.gradients.push_back(map.grad().cpu());
    return rendered;
}

TEST(CudaDevice, ImagesAndGradientsAreTheCpus) {
    SKIP_WITHOUT_DEVICE();
    const Scene scene = make_scene();
    const Rendered cpu = render_scene(scene, at::kCPU);
    for (const bool deterministic : {false, true}) {
        const Deterministic guard(deterministic);
        const Rendered device = render_scene(scene, at::Device(at::kCUDA, 0));
        EXPECT_LT(relative_error(device.image, cpu.image), 1e-4);
        for (std::size_t i = 0; i < cpu.gradients.size(); ++i)
            EXPECT_LT(relative_error(device.gradients[i], cpu.gradients[i]), 1e-3)
                << "gradient " << i;
        if (!deterministic) continue;
        const Rendered again = render_scene(scene, at::Device(at::kCUDA, 0));
        for (std::size_t i = 0; i < cpu.gradients.size(); ++i)
            EXPECT_TRUE(at::equal(device.gradients[i], again.gradients[i])) << "gradient " << i;
    }
}

/// Looks up a texture and its mip levels, and returns the gradients of texels and UVs.
Rendered sample_pyramid(at::Device device) {
    at::manual_seed(12);
    const auto leaf = [&](const at::Tensor& tensor) {
        return tensor.to(device).detach().clone().set_requires_grad(true);
    };
    const at::Tensor texture = leaf(at::rand({32, 64, 4}));
    const at::Tensor uv = leaf(3 * at::rand({5000, 2}) - 1);
    const at::Tensor footprint = 0.05f * at::randn({5000, 4});
    const at::Tensor weights = at::randn({5000, 4});
    const at::Tensor values = sample_texture(texture_pyramid(texture), uv, footprint.to(device),
                                             Wrap::repeat, Wrap::mirrored_repeat);
    (values * weights.to(device)).sum().backward();
    return {values.detach().cpu(), {texture.grad().cpu(), uv.grad().cpu()}};
}

TEST(CudaDevice, TextureLookupsAreTheCpus) {
    SKIP_WITHOUT_DEVICE();
    const Rendered cpu = sample_pyramid(at::kCPU);
    for (const bool deterministic : {false, true}) {
        const Deterministic guard(deterministic);
        const Rendered device = sample_pyramid(at::Device(at::kCUDA, 0));
        EXPECT_LT(relative_error(device.image, cpu.image), 1e-4);
        EXPECT_LT(relative_error(device.gradients[0], cpu.gradients[0]), 1e-3);
        EXPECT_LT(relative_error(device.gradients[1], cpu.gradients[1]), 1e-3);
    }
}

/// The model has two layers, one of them translucent, and a texture whose size is not a power of
/// two.
TEST(CudaDevice, ImagesOfTexturedModelsAreTheCpus) {
    SKIP_WITHOUT_DEVICE();
    at::manual_seed(13);
    Model model = make_unit_sphere(24, 48);
    model.textures.push_back(
        {"noise", to_image(at::rand({30, 50, 4})), 8, Wrap::repeat, Wrap::clamp_to_edge});
    Material glass;
    glass.base_color_texture = 0;
    glass.alpha = Material::Alpha::blend;
    Material lamp;
    lamp.emissive_factor = Vec3(0.2f, 0.1f, 0.0f);
    lamp.metallic_roughness_texture = 0;
    model.materials = {glass, lamp};
    Primitive inner = model.primitives[0];
    for (Vec3& position : inner.positions)
        position = 0.6f * position;
    model.primitives[0].material = 0;
    inner.material = 1;
    model.primitives.push_back(inner);
    const EnvironmentLight light{testing::smooth_cube(16),
                                 {testing::smooth_cube(32, 4), testing::smooth_cube(16, 5),
                                  testing::smooth_cube(16, 6), testing::smooth_cube(16, 7)},
                                 {0.1f, 0.25f, 0.5f, 0.9f}};
    RenderOptions options;
    options.width = 80;
    options.height = 64;
    options.background = Vec3(0.2f, 0.3f, 0.4f);
    std::vector<at::Tensor> images;
    for (const at::Device device : {at::Device(at::kCPU), at::Device(at::kCUDA, 0)}) {
        const at::NoGradGuard no_gradients;
        images.push_back(render(Geometry::from_model(model, device),
                                TexturedMaterials(model, device), light.to(device),
                                {front_camera(3), front_camera(2.2f, 0.6f)}, options)
                             .cpu());
    }
    EXPECT_LT(relative_error(images[1], images[0]), 1e-3);
}

TEST(CudaDevice, EquirectangularMapsAreTheCpus) {
    SKIP_WITHOUT_DEVICE();
    at::manual_seed(3);
    const at::Tensor map = at::rand({32, 64, 3}), weights = at::randn({6, 16, 16, 3});
    std::vector<at::Tensor> cubes, gradients;
    for (const at::Device device : {at::Device(at::kCPU), at::Device(at::kCUDA, 0)}) {
        const at::Tensor leaf = map.to(device).detach().clone().set_requires_grad(true);
        const at::Tensor cube = equirectangular_to_cube(leaf, 16);
        (cube * weights.to(device)).sum().backward();
        cubes.push_back(cube.detach().cpu());
        gradients.push_back(leaf.grad().cpu());
    }
    EXPECT_LT(relative_error(cubes[1], cubes[0]), 1e-4);
    EXPECT_LT(relative_error(gradients[1], gradients[0]), 1e-3);
}

}  // namespace
}  // namespace item3d
