// Tests of prefiltering as a device's threads compute it. The functions run on the CPU, one index
// after another, against the CPU's own algorithm, and on a device if there is one.
#include "item3d/render/cuda/module.h"
#include "item3d/render/occlusion/occlusion.h"
#include "item3d/render/prefilter/irradiance_sums.h"
#include "item3d/render/prefilter/specular_sums.h"
#include "item3d/render/prefilter/tensor_backend.h"
#include "tests/support/render.h"

#include <algorithm>
#include <array>

namespace item3d {
namespace {

using kernels::ZonalKernel;

const TensorBackend on_cpu(at::kCPU);

CubePlanes planes_of(const at::Tensor& map, const at::Tensor& weight) {
    const auto size = static_cast<int>(map.size(1));
    return to_planes(CubeMap::contiguous(map.const_data_ptr<float>(), size),
                     weight.const_data_ptr<float>(), true, on_cpu);
}

/// Returns cube planes of random values, whose halos are filled.
CubePlanes random_planes(int size) {
    at::manual_seed(4);
    const at::Tensor map = at::rand({6, size, size, 3});
    return planes_of(map, at::rand({size, size}) + 0.5f);
}

/// Returns the map and, as a fourth channel, the shared plane: [6, S, S, 4].
at::Tensor values_of(const CubePlanes& planes) {
    const at::Tensor map = at::empty({6, planes.size(), planes.size(), 3});
    from_planes(planes, at::ones({planes.size(), planes.size()}).const_data_ptr<float>(),
                map.data_ptr<float>());
    at::Tensor shared = at::empty({planes.size(), planes.size()});
    for (int y = 0; y < planes.size(); ++y)
        for (int x = 0; x < planes.size(); ++x)
            shared[y][x] = planes.view().row(18, y)[x];
    return at::cat({map, shared.expand({6, -1, -1}).unsqueeze(-1)}, -1);
}

void expect_close(const at::Tensor& found, const at::Tensor& expected, double bound = 1e-5) {
    const double largest = expected.abs().max().item<double>();
    ASSERT_GT(largest, 0);
    EXPECT_LT((found.cpu() - expected).abs().max().item<double>(), bound * largest);
}

/// Returns a GGX kernel that ends at the squared chord `outer`.
ZonalKernel lobe(float roughness, float outer) {
    ZonalKernel kernel{};
    kernel.alpha2 = roughness * roughness * roughness * roughness;
    kernel.outer = outer;
    kernel.floor = kernel.profile(outer);
    return kernel;
}

TEST(CudaKernels, NearSumsOfATexelAreThoseOfTheLanes) {
    constexpr int size = 64;
    const CubePlanes map = random_planes(size);
    const CubeDirections directions(size, on_cpu);
    const ZonalKernel kernel = lobe(0.2f, 0.006f);
    CubePlanes found(size, true, on_cpu);
    found.clear();
    add_near_sums(map, directions, kernel, found);
    CubePlanes expected(size, true, on_cpu);
    const kernels::Planes out = expected.writable();
    near_sums(map, directions, kernel, nullptr, [&](int row, int column, const float* sums) {
        for (int plane = 0; plane < out.count; ++plane)
            std::copy_n(sums + plane * kernels::row_tile, kernels::row_tile,
                        out.row(plane, row) + column);
    });
    expect_close(values_of(found), values_of(expected));
}

/// Computes far_sums() by the kernels for devices, which run on the CPU here: turn_planes()
/// reorders the planes for each run of 4 texels, and far_sums_of_texel() sums for one texel.
CubePlanes far_sums_by_texels(const CubePlanes& map, const ZonalKernel& kernel) {
    const int size = map.size();
    const at::Tensor turned = at::zeros({19 * kernels::far_plane(size)});
    const kernels::TurnParameters turn{map.view(), turned.data_ptr<float>(), 6, 4};
    for (std::int64_t i = 0; i < 6 * 19 * size * (size / 4); ++i)
        kernels::turn_planes(turn, i);
    const at::Tensor centres = (2 * at::arange(size) + 1).to(at::kFloat) / size - 1;
    const at::Tensor lengths =
        (1 + centres.square() + centres.square().unsqueeze(1)).rsqrt().contiguous();
    CubePlanes out(size, true, on_cpu);
    const float reach = kernel.reach();
    const kernels::FarParameters p{kernel,
                                   turned.const_data_ptr<float>(),
                                   size,
                                   19,
                                   out.writable(),
                                   centres.const_data_ptr<float>(),
                                   lengths.const_data_ptr<float>(),
                                   std::sin(std::min(reach, 0.5f * pi)),
                                   -1};
    for (std::int64_t i = 0; i < size * size; ++i)
        kernels::far_sums_of_texel<false>(p, i);
    return out;
}

TEST(CudaKernels, FarSumsOfATexelAreThoseOfTheLanes) {
    const CubePlanes map = random_planes(16);
    for (const ZonalKernel& kernel : {lobe(0.5f, 0.3f), lobe(1.0f, 2.0f)})
        expect_close(values_of(far_sums_by_texels(map, kernel)), values_of(far_sums(map, kernel)));
}

TEST(CudaKernels, ShortRunsGiveWhatLongOnesGive) {
    constexpr int size = 32, fine_size = 64, run = kernels::device_resized_run;
    const CubePlanes map = random_planes(size);
    CubePlanes fine(fine_size, true, on_cpu);
    for (std::int64_t i = 0; i < 19 * fine_size * fine_size / run; ++i)
        kernels::upsample<run>({map.view(), fine.writable(), false}, i);
    EXPECT_TRUE(at::equal(values_of(fine), values_of(upsampled(map))));

    CubePlanes coarse(size / 2, true, on_cpu);
    for (std::int64_t i = 0; i < 19 * size * size / 4 / (run / 2); ++i)
        kernels::restrict_run<run>({map.view(), coarse.writable(), false}, i);
    EXPECT_TRUE(at::equal(values_of(coarse), values_of(restricted(map))));

    // The halos are filled texel by texel, in planes that have none.
    CubePlanes filled(size, true, on_cpu);
    filled.clear();
    for (int plane = 0; plane < 19; ++plane)
        for (int y = 0; y < size; ++y)
            std::copy_n(map.view().row(plane, y), size, filled.writable().row(plane, y));
    const kernels::HaloParameters halo{filled.writable(), CubePlanes::halo, 1};
    for (std::int64_t i = 0; i < 19 * 4 * CubePlanes::halo * size; ++i)
        kernels::fill_halo_side(halo, i);
    for (std::int64_t i = 0; i < 19 * 4; ++i)
        kernels::fill_halo_corner(halo, i);
    for (int plane = 0; plane < 19; ++plane)
        for (int y = -CubePlanes::halo; y < size + CubePlanes::halo; ++y)
            for (int x = -CubePlanes::halo; x < size + CubePlanes::halo; ++x)
                ASSERT_EQ(filled.view().row(plane, y)[x], map.view().row(plane, y)[x])
                    << plane << " " << y << " " << x;
}

/// Returns a dim map with a few bright texels.
at::Tensor map_with_lamps(int size) {
    at::Tensor map = testing::smooth_cube(size);
    map[2][size / 3][size / 2] = 4000.0f;
    map[4][1][size - 1] = 2000.0f;
    return map;
}

TEST(CudaKernels, BrightTexelsInShortRuns) {
    constexpr int size = 32, run = kernels::device_bright_run;
    const CubePlanes flux = planes_of(map_with_lamps(size), at::full({size, size}, 1e-3f));
    const at::Tensor bright = at::empty({max_bright}, at::kLong);
    bright_texels(flux, bright.data_ptr<std::int64_t>());
    ASSERT_EQ((bright >= 0).sum().item<int>(), 2);
    kernels::BrightParameters p{};
    p.texels = bright.const_data_ptr<std::int64_t>();
    p.count = static_cast<int>(bright.numel());
    p.size = size;
    p.flux = flux.view();
    const std::int64_t normals = 6 * irradiance_size * irradiance_size;
    std::array<at::Tensor, 2> irradiance;
    for (const int length : {1, irradiance_size}) {
        CubePlanes sums(irradiance_size, true, on_cpu);
        sums.clear();
        p.out = sums.writable();
        for (std::int64_t i = 0; i < normals / length; ++i)
            length == 1 ? kernels::add_bright<1>(p, i) : kernels::add_bright<irradiance_size>(p, i);
        irradiance[length == 1 ? 0 : 1] = values_of(sums);
    }
    expect_close(irradiance[0], irradiance[1], 1e-6);

    const CubePlanes gradient = random_planes(irradiance_size);
    p.gradient = gradient.view();
    std::array<at::Tensor, 2> sums;
    for (const int length : {run, irradiance_size}) {
        const at::Tensor partial = at::empty({normals / length, p.count, 3});
        p.partial_sums = partial.data_ptr<float>();
        for (std::int64_t i = 0; i < normals / length; ++i)
            length == run ? kernels::sum_bright<run>(p, i)
                          : kernels::sum_bright<irradiance_size>(p, i);
        sums[length == run ? 0 : 1] = partial.to(at::kDouble).sum(0);
    }
    expect_close(sums[0], sums[1]);
}

TEST(CudaDevice, PrefilteredLightIsTheCpus) {
    if (!cuda::cuda_available()) GTEST_SKIP() << "no CUDA device, or no libtorch_cuda.so";
    std::vector<std::vector<at::Tensor>> maps, gradients;
    for (const at::Device device : {at::Device(at::kCPU), at::Device(at::kCUDA, 0)}) {
        const at::Tensor cube =
            map_with_lamps(128).to(device).detach().clone().set_requires_grad(true);
        const EnvironmentLight light = prefilter(cube);
        at::Tensor loss = (light.diffuse * light.diffuse.detach().cos()).sum();
        std::vector<at::Tensor> found{light.diffuse.detach().cpu()};
        for (const at::Tensor& level : light.specular) {
            loss = loss + (level * level.detach().cos()).sum();
            found.push_back(level.detach().cpu());
        }
        loss.backward();
        maps.push_back(found);
        gradients.push_back({cube.grad().cpu()});
    }
    for (std::size_t i = 0; i < maps[0].size(); ++i)
        expect_close(maps[1][i], maps[0][i], 1e-4);
    expect_close(gradients[1][0], gradients[0][0], 1e-3);
}

TEST(CudaDevice, OcclusionIsTheCpus) {
    if (!cuda::cuda_available()) GTEST_SKIP() << "no CUDA device, or no libtorch_cuda.so";
    const at::NoGradGuard no_gradients;
    Model model = make_unit_sphere(24, 48);
    Primitive neighbour = model.primitives[0];
    for (Vec3& position : neighbour.positions)
        position = 0.5f * position + Vec3(1.3f, 0, 0);
    model.primitives.push_back(neighbour);
    std::vector<at::Tensor> openness;
    for (const at::Device device : {at::Device(at::kCPU), at::Device(at::kCUDA, 0)}) {
        const Geometry geometry = Geometry::from_model(model, device);
        const std::vector<Camera> cameras{testing::front_camera(4)};
        const Raster raster = rasterize(geometry, cameras, 64, 64);
        const Surface surface = interpolate_surface(geometry, raster, cameras);
        openness.push_back(Occlusion(geometry, &model).at(raster, surface).cpu());
    }
    expect_close(openness[1], openness[0], 1e-4);
}

}  // namespace
}  // namespace item3d
