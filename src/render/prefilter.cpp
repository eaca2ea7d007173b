// The prefiltered chain of split-sum lighting. Every step is linear in the environment.

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/render/checks.h"
#include "item3d/render/environment_light.h"
#include "item3d/render/kernels/zonal.h"
#include "item3d/render/shade.h"

#include <torch/csrc/autograd/custom_function.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace item3d {
namespace {

using kernels::ZonalKernel;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

constexpr int coarsest_size = 16;                    ///< of what far texels are summed on
constexpr int least_size = 16, largest_size = 1024;  ///< of an environment
constexpr float finest_roughness = 0.08f;
constexpr float chain_roughness = 0.5f;  ///< of the smallest level's first lobe
constexpr std::array<float, 4> wide_roughness = {chain_roughness, 0.63f, 0.79f, 1.0f};
constexpr float kept_energy = 0.999f;
constexpr int diffuse_size = 32;
/// How far texels are summed at full resolution, in texels at a face's centre: between the
/// reference report's error for smooth metal, which falls with it, and time, which grows.
constexpr float near_texels = 3;

/// Solid angles of a face's texels, [size, size], exact.
torch::Tensor texel_solid_angles(int size) {
    std::vector<double> corner(static_cast<std::size_t>(size + 1) * (size + 1));
    const auto at = [&](int y, int x) -> double& {
        return corner[static_cast<std::size_t>(y) * (size + 1) + x];
    };
    for (int y = 0; y <= size; ++y) {
        for (int x = 0; x <= size; ++x) {
            const double s = 2.0 * x / size - 1, t = 2.0 * y / size - 1;
            at(y, x) = std::atan2(s * t, std::sqrt(s * s + t * t + 1));
        }
    }
    torch::Tensor angles = torch::empty({size, size});
    float* out = angles.data_ptr<float>();
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            *out++ = static_cast<float>(at(y + 1, x + 1) - at(y, x + 1) - at(y + 1, x) + at(y, x));
    return angles;
}

ZonalKernel cosine_kernel() {
    ZonalKernel kernel{};
    kernel.cosine = true;
    kernel.outer = 2;
    return kernel;
}

/// energy: the share of the lobe's half vectors that is kept, below 1.
ZonalKernel ggx_kernel(float roughness, float energy) {
    ZonalKernel kernel{};
    const float alpha = roughness * roughness;
    kernel.alpha2_1 = alpha * alpha - 1;
    // D(h) (n.h) has the cumulative distribution tan^2 / (alpha^2 + tan^2).
    const float tangent = alpha * std::sqrt(energy / (1 - energy));
    const float cosine = std::max(0.0f, std::cos(2 * std::atan(tangent)));
    kernel.floor = kernel.profile<false>(cosine);
    kernel.outer = 2 - 2 * cosine;
    return kernel;
}

struct SplitKernel {
    ZonalKernel near, rest;
};

/// Cuts GGX at the squared chord `at`: the rest continues inwards as a parabola that meets the
/// kernel there with its first and second derivatives.
SplitKernel split_kernel(const ZonalKernel& kernel, float at) {
    const double a = kernel.alpha2_1, d = at, c = 1 - 0.5 * d;
    const double q = 0.5 * (1 + c) * a + 1;
    const double value = c / (q * q) - static_cast<double>(kernel.floor);
    const double slope = -0.5 * (1 / (q * q) - c * a / (q * q * q));
    const double bend = 0.25 * (-2 * a / (q * q * q) + 1.5 * c * a * a / (q * q * q * q));
    const float cap[3] = {static_cast<float>(value - slope * d + 0.5 * bend * d * d),
                          static_cast<float>(slope - bend * d), static_cast<float>(0.5 * bend)};
    SplitKernel split{kernel, kernel};
    split.near.outer = split.rest.inner = at;
    std::copy(cap, cap + 3, split.near.outer_cap);
    std::copy(cap, cap + 3, split.rest.inner_cap);
    return split;
}

using Gather = void (*)(const kernels::ZonalParameters&, std::int64_t);

#if defined(__x86_64__) && defined(__GNUC__)
// The sums take nearly all of the time, and eight lanes halve it.
template <bool Cosine>
__attribute__((target("avx2,fma"))) void zonal_gather_avx2(const kernels::ZonalParameters& p,
                                                           std::int64_t index) {
    kernels::zonal_gather<Cosine>(p, index);
}
template <bool Cosine>
Gather fastest_gather() {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
               ? zonal_gather_avx2<Cosine>
               : kernels::zonal_gather<Cosine>;
}
#else
template <bool Cosine>
Gather fastest_gather() {
    return kernels::zonal_gather<Cosine>;
}
#endif

/// flux [6, S, S, 4] as ZonalParameters::source wants it.
torch::Tensor turned_planes(const torch::Tensor& flux_) {
    const torch::Tensor flux = flux_.contiguous();
    const auto size = static_cast<int>(flux.size(1));
    const std::int64_t plane = kernels::zonal_plane(size);
    torch::Tensor planes = torch::empty({6, 4, plane});
    const float* in = flux.const_data_ptr<float>();
    float* out = planes.data_ptr<float>();
    const std::int64_t face_texels = static_cast<std::int64_t>(size) * size;
    parallel_for(
        "turn_planes", 36 * static_cast<std::int64_t>(size),
        [=](std::int64_t i) {
            const auto row = static_cast<int>(i % size), face = static_cast<int>(i / size % 6);
            const auto to = static_cast<int>(i / size / 6);
            const kernels::TurnedFace turned = kernels::turned_face(to, face, size);
            const float* source = in + 4 * (turned.face * face_texels + turned.first +
                                            static_cast<std::int64_t>(row) * turned.row_step);
            float* target = out + 4 * plane * to + (face * size + row) * kernels::zonal_row(size);
            for (int column = 0; column < size; ++column)
                for (int c = 0; c < 4; ++c)
                    target[plane * c + column] = source[4 * turned.column_step * column + c];
        },
        16);
    return planes;
}

/// Sums [6, R, R, 4] of the kernel over turned_planes().
torch::Tensor zonal_sums(const torch::Tensor& planes, int size, int out_size,
                         const ZonalKernel& kernel) {
    torch::Tensor out = torch::empty({6, out_size, out_size, 4}, torch::kFloat32);
    std::vector<float> centres(static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i)
        centres[static_cast<std::size_t>(i)] = kernels::texel_centre(i, size);
    std::vector<float> inverse_lengths;
    inverse_lengths.reserve(centres.size() * centres.size());
    for (const float t : centres)
        for (const float s : centres)
            inverse_lengths.push_back(1 / std::sqrt(1 + s * s + t * t));
    const float reach = kernel.reach();
    // The corners of a face are 54.7 degrees off its centre.
    const float farthest = reach + 0.9554f;
    const kernels::ZonalParameters parameters{kernel,
                                              planes.const_data_ptr<float>(),
                                              size,
                                              out.data_ptr<float>(),
                                              out_size,
                                              centres.data(),
                                              inverse_lengths.data(),
                                              std::sin(std::min(reach, 0.5f * pi)),
                                              farthest < pi ? std::cos(farthest) : -1.0f};
    const Gather gather = kernel.cosine ? fastest_gather<true>() : fastest_gather<false>();
    // In squares, whose neighbourhoods in 24 planes stay in a core's cache.
    constexpr std::int64_t square = 16;
    const std::int64_t across = out_size / square;
    parallel_for(
        "zonal_gather", static_cast<std::int64_t>(out_size) * out_size,
        [=](std::int64_t i) {
            const std::int64_t tile = i / (square * square), within = i % (square * square);
            const std::int64_t row = tile / across * square + within / square;
            const std::int64_t column = tile % across * square + within % square;
            gather(parameters, row * out_size + column);
        },
        square);
    return out;
}

/// flux [6, S, S, 4] and its turned_planes() -> its sums under the kernel [6, R, R, 4].
struct ZonalSum : torch::autograd::Function<ZonalSum> {
    static torch::Tensor forward(AutogradContext* context, const torch::Tensor& flux,
                                 const torch::Tensor& planes, std::int64_t out_size,
                                 const ZonalKernel& kernel) {
        context->saved_data["size"] = flux.size(1);
        std::vector<double> numbers{kernel.cosine ? 1.0 : 0.0, kernel.alpha2_1, kernel.floor,
                                    kernel.inner, kernel.outer};
        numbers.insert(numbers.end(), kernel.inner_cap, kernel.inner_cap + 3);
        numbers.insert(numbers.end(), kernel.outer_cap, kernel.outer_cap + 3);
        context->saved_data["kernel"] = numbers;
        return zonal_sums(planes, static_cast<int>(flux.size(1)), static_cast<int>(out_size),
                          kernel);
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const std::vector<double> k = context->saved_data["kernel"].toDoubleVector();
        const auto number = [&](std::size_t i) { return static_cast<float>(k[i]); };
        const ZonalKernel kernel{k[0] != 0,
                                 number(1),
                                 number(2),
                                 number(3),
                                 {number(5), number(6), number(7)},
                                 number(4),
                                 {number(8), number(9), number(10)}};
        return {zonal_sums(turned_planes(gradients[0]), static_cast<int>(gradients[0].size(1)),
                           static_cast<int>(context->saved_data["size"].toInt()), kernel),
                torch::Tensor(), torch::Tensor(), torch::Tensor()};
    }
};

/// [6, R, R, 4] -> [6, 2R, 2R, 4], bilinear.
torch::Tensor upsampled(const torch::Tensor& coarse_) {
    const torch::Tensor coarse = coarse_.contiguous();
    const auto size = static_cast<int>(coarse.size(1));
    torch::Tensor fine = torch::empty({6, 2 * size, 2 * size, 4});
    const float* in = coarse.const_data_ptr<float>();
    float* out = fine.data_ptr<float>();
    parallel_for(
        "upsample_cube", fine.numel() / 4,
        [=](std::int64_t i) { kernels::upsample_cube(in, size, i, out); }, 4096);
    return fine;
}

/// The transpose of upsampled().
torch::Tensor restricted(const torch::Tensor& fine_) {
    const torch::Tensor fine = fine_.contiguous();
    const auto size = static_cast<int>(fine.size(1)), half = size / 2;
    torch::Tensor coarse = torch::empty({6, half, half, 4});
    const float* in = fine.const_data_ptr<float>();
    float* out = coarse.data_ptr<float>();
    parallel_for(
        "restrict_cube", coarse.numel() / 4,
        [=](std::int64_t i) { kernels::upsample_cube_backward(in, half, i, out); }, 4096);
    // What crosses an edge goes to another face: few texels, added in order.
    for (int face = 0; face < 6; ++face) {
        for (int y = 0; y < size; ++y) {
            const bool border_row = y == 0 || y == size - 1;
            for (int x = 0; x < size; x += border_row ? 1 : size - 1) {
                const kernels::CubeTaps taps =
                    kernels::cube_taps(kernels::cube_direction(face, kernels::texel_centre(x, size),
                                                               kernels::texel_centre(y, size)),
                                       half);
                const float* value = in + 4 * ((face * size + y) * size + x);
                for (int i = 0; i < 4; ++i) {
                    if (taps.texel[i] / (half * half) == face) continue;
                    for (int c = 0; c < 4; ++c)
                        out[4 * taps.texel[i] + c] += taps.weight[i] * value[c];
                }
            }
        }
    }
    return coarse;
}

struct UpsampleCube : torch::autograd::Function<UpsampleCube> {
    static torch::Tensor forward(AutogradContext*, const torch::Tensor& coarse) {
        return upsampled(coarse);
    }
    static tensor_list backward(AutogradContext*, tensor_list gradients) {
        return {restricted(gradients[0])};
    }
};

torch::Tensor mean_radiance(const torch::Tensor& sums) {
    return sums.narrow(3, 0, 3) / sums.narrow(3, 3, 1).detach().clamp_min(1e-30f);
}

/// A resolution of the environment.
struct FluxLevel {
    torch::Tensor flux;    ///< [6, S, S, 4] radiance times solid angle, and the solid angle
    torch::Tensor planes;  ///< turned_planes(flux), for all lobes
    std::int64_t size() const { return flux.size(1); }
};

/// Sums over a level of the chain at its own resolution, far texels on coarser levels down to
/// `last`.
torch::Tensor multilevel_sums(const std::vector<FluxLevel>& chain, std::size_t level,
                              std::size_t last, const ZonalKernel& kernel) {
    const auto& [flux, planes] = chain[level];
    const std::int64_t size = flux.size(1);
    const float near = near_texels * 2 / static_cast<float>(size);
    if (level == last || near * near >= 0.7f * kernel.outer)
        return ZonalSum::apply(flux, planes, size, kernel);
    const SplitKernel split = split_kernel(kernel, near * near);
    return ZonalSum::apply(flux, planes, size, split.near) +
           UpsampleCube::apply(multilevel_sums(chain, level + 1, last, split.rest));
}

}  // namespace

EnvironmentLight EnvironmentLight::to(torch::Device device) const {
    EnvironmentLight moved{diffuse.to(device), {}, roughness};
    for (const torch::Tensor& level : specular)
        moved.specular.push_back(level.to(device));
    return moved;
}

EnvironmentLight prefilter(const torch::Tensor& cube_) {
    const torch::Tensor cube = checked("prefilter", "cube", cube_, torch::kFloat32, {6, -1, -1, 3});
    const int size = static_cast<int>(cube.size(1));
    ITEM3D_CHECK(cube.size(2) == size && size >= least_size && size <= largest_size &&
                     (size & (size - 1)) == 0,
                 "prefilter: cube must be [6, S, S, 3] with S a power of two in [16, 1024], found "
                 "S = " +
                     std::to_string(size) + " and " + std::to_string(cube.size(2)));

    const torch::Tensor angles = texel_solid_angles(size).unsqueeze(-1).expand({6, size, size, 1});
    std::vector<FluxLevel> chain{{torch::cat({cube * angles, angles}, 3), {}}};
    while (chain.back().size() > coarsest_size) {
        const std::int64_t half = chain.back().size() / 2;
        chain.push_back({chain.back().flux.reshape({6, half, 2, half, 2, 4}).sum({2, 4}), {}});
    }
    for (FluxLevel& level : chain)
        level.planes = turned_planes(level.flux.detach());
    const std::size_t smallest = chain.size() - (size > coarsest_size ? 2 : 1);  // 32 texels

    EnvironmentLight light;
    const FluxLevel& diffuse = chain[smallest > 0 ? smallest - 1 : 0];
    light.diffuse = mean_radiance(
        ZonalSum::apply(diffuse.flux, diffuse.planes, std::int64_t{diffuse_size}, cosine_kernel()));
    const auto add = [&](std::size_t level, std::size_t last, float roughness) {
        light.specular.push_back(
            mean_radiance(multilevel_sums(chain, level, last, ggx_kernel(roughness, kept_energy))));
        light.roughness.push_back(roughness);
    };
    // Two lobes a resolution: the shading blends neighbours, which shows when they are far apart.
    const std::size_t lobes = std::max<std::size_t>(1, 2 * smallest);
    for (std::size_t lobe = 0; lobe < lobes; ++lobe)
        add(lobe / 2, smallest,
            finest_roughness * std::pow(chain_roughness / finest_roughness,
                                        static_cast<float>(lobe) / static_cast<float>(lobes)));
    // Lobes this wide lose nothing by one level more.
    for (const float roughness : wide_roughness)
        add(smallest, chain.size() - 1, roughness);
    return light;
}

EnvironmentLight prefilter(const Image& equirectangular, int size, torch::Device device) {
    const torch::NoGradGuard no_gradient;
    torch::Tensor pixels = to_tensor(equirectangular);
    ITEM3D_CHECK(pixels.dim() == 3 && pixels.size(2) >= 3, "prefilter: an image of RGB radiance");
    return prefilter(equirectangular_to_cube(pixels.narrow(2, 0, 3), size)).to(device);
}

}  // namespace item3d
