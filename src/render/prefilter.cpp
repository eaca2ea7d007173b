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

constexpr int smallest_size = 32;                    ///< of the chain
constexpr int coarsest_size = 16;                    ///< of what far texels are summed on
constexpr int least_size = 16, largest_size = 1024;  ///< of an environment
constexpr float finest_roughness = 0.08f;
constexpr float chain_roughness = 0.5f;  ///< of the smallest level's first lobe
constexpr std::array<float, 4> wide_roughness = {chain_roughness, 0.63f, 0.79f, 1.0f};
constexpr float kept_energy = 0.999f;
constexpr int diffuse_size = 32;
/// How far texels are summed at full resolution, in texels at a face's centre. Measured: 3 changes
/// a lobe's mean by less than NEAR_ERROR.
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

/// [6, S, S, 3] and solid-angle-like [S, S] or [6, S, S] -> planes [4, 6, S, S].
torch::Tensor to_planes(const torch::Tensor& colors, const torch::Tensor& fourth) {
    const std::int64_t size = colors.size(1);
    return torch::cat({colors.permute({3, 0, 1, 2}), fourth.expand({1, 6, size, size})}, 0)
        .contiguous();
}

using AddRow = void (*)(const ZonalKernel&, const kernels::ZonalRow&, kernels::ZonalSums&);

#if defined(__x86_64__) && defined(__GNUC__)
// The rows take nearly all of the time, and eight lanes halve it.
template <bool Cosine>
__attribute__((target("avx2,fma"))) void zonal_row_avx2(const ZonalKernel& kernel,
                                                        const kernels::ZonalRow& row,
                                                        kernels::ZonalSums& sums) {
    kernels::zonal_row<Cosine>(kernel, row, sums);
}
template <bool Cosine>
AddRow fastest_row() {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
               ? zonal_row_avx2<Cosine>
               : kernels::zonal_row<Cosine>;
}
#else
template <bool Cosine>
AddRow fastest_row() {
    return kernels::zonal_row<Cosine>;
}
#endif

/// Sums [6, R, R, 4] of the kernel over planes [4, 6, S, S].
torch::Tensor zonal_sums(const torch::Tensor& planes, int out_size, const ZonalKernel& kernel) {
    const int size = static_cast<int>(planes.size(2));
    torch::Tensor out = torch::empty({6, out_size, out_size, 4}, torch::kFloat32);
    std::vector<float> centres(static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i)
        centres[static_cast<std::size_t>(i)] = kernels::texel_centre(i, size);
    std::vector<float> inverse_lengths;
    for (const float t : centres)
        for (const float s : centres)
            inverse_lengths.push_back(1 / std::sqrt(1 + s * s + t * t));
    const kernels::ZonalParameters parameters{
        kernel,         planes.const_data_ptr<float>(), size, out.data_ptr<float>(), out_size,
        centres.data(), inverse_lengths.data()};
    const AddRow add_row = kernel.cosine ? fastest_row<true>() : fastest_row<false>();
    parallel_for(
        "zonal_gather", 6 * static_cast<std::int64_t>(out_size) * out_size,
        [=](std::int64_t i) { kernels::zonal_gather(parameters, i, add_row); }, 64);
    return out;
}

/// flux [6, S, S, 3] and solid angles -> sums of both under the kernel [6, R, R, 4].
struct ZonalSum : torch::autograd::Function<ZonalSum> {
    static torch::Tensor forward(AutogradContext* context, const torch::Tensor& flux,
                                 const torch::Tensor& solid_angles, std::int64_t out_size,
                                 const ZonalKernel& kernel) {
        context->saved_data["size"] = flux.size(1);
        std::vector<double> numbers{kernel.cosine ? 1.0 : 0.0, kernel.alpha2_1, kernel.floor,
                                    kernel.inner, kernel.outer};
        numbers.insert(numbers.end(), kernel.inner_cap, kernel.inner_cap + 3);
        numbers.insert(numbers.end(), kernel.outer_cap, kernel.outer_cap + 3);
        context->saved_data["kernel"] = numbers;
        return zonal_sums(to_planes(flux, solid_angles), static_cast<int>(out_size), kernel);
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
        const torch::Tensor sums =
            zonal_sums(to_planes(gradients[0].narrow(3, 0, 3), torch::zeros({1})),
                       static_cast<int>(context->saved_data["size"].toInt()), kernel);
        return {sums.narrow(3, 0, 3), torch::Tensor(), torch::Tensor(), torch::Tensor()};
    }
};

/// [6, R, R, 4] -> [6, 2R, 2R, 4]
struct UpsampleCube : torch::autograd::Function<UpsampleCube> {
    static torch::Tensor forward(AutogradContext*, const torch::Tensor& coarse) {
        const auto size = static_cast<int>(coarse.size(1));
        torch::Tensor fine = torch::empty({6, 2 * size, 2 * size, 4});
        const float* in = coarse.const_data_ptr<float>();
        float* out = fine.data_ptr<float>();
        parallel_for(
            "upsample_cube", fine.numel() / 4,
            [=](std::int64_t i) { kernels::upsample_cube(in, size, i, out); }, 4096);
        return fine;
    }
    static tensor_list backward(AutogradContext*, tensor_list gradients) {
        const torch::Tensor gradient = gradients[0].contiguous();
        const auto size = static_cast<int>(gradient.size(1)), half = size / 2;
        torch::Tensor coarse = torch::empty({6, half, half, 4});
        const float* in = gradient.const_data_ptr<float>();
        float* out = coarse.data_ptr<float>();
        parallel_for(
            "upsample_cube backward", coarse.numel() / 4,
            [=](std::int64_t i) { kernels::upsample_cube_backward(in, half, i, out); }, 4096);
        // What crosses an edge goes to another face: few texels, added in order.
        for (int face = 0; face < 6; ++face) {
            for (int y = 0; y < size; ++y) {
                const bool border_row = y == 0 || y == size - 1;
                for (int x = 0; x < size; x += border_row ? 1 : size - 1) {
                    const kernels::CubeTaps taps = kernels::cube_taps(
                        kernels::cube_direction(face, kernels::texel_centre(x, size),
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
        return {coarse};
    }
};

/// The environment at all resolutions, finest first.
class Pyramid {
  public:
    explicit Pyramid(const torch::Tensor& cube) {
        const torch::Tensor angles = texel_solid_angles(static_cast<int>(cube.size(1)));
        levels_.push_back({cube * angles.unsqueeze(-1), angles});
        while (size(count() - 1) > coarsest_size) {
            const std::int64_t half = size(count() - 1) / 2;
            const Level& fine = levels_.back();
            levels_.push_back({fine.flux.reshape({6, half, 2, half, 2, 3}).sum({2, 4}),
                               fine.solid_angles.reshape({half, 2, half, 2}).sum({1, 3})});
        }
    }
    int count() const { return static_cast<int>(levels_.size()); }
    int size(int level) const {
        return static_cast<int>(levels_[static_cast<std::size_t>(level)].flux.size(1));
    }
    /// Mean radiance under the kernel, [6, R, R, 3], summed over one level's texels.
    torch::Tensor mean(int level, int out_size, const ZonalKernel& kernel) const {
        return normalized(sums(level, out_size, kernel));
    }
    /// The same at the level's own resolution, far texels summed on coarser levels.
    torch::Tensor multilevel_mean(int level, const ZonalKernel& kernel) const {
        return normalized(multilevel_sums(level, kernel));
    }

  private:
    struct Level {
        torch::Tensor flux;          ///< [6, S, S, 3] radiance times solid angle
        torch::Tensor solid_angles;  ///< [S, S]
    };
    static torch::Tensor normalized(const torch::Tensor& sums) {
        return sums.narrow(3, 0, 3) / sums.narrow(3, 3, 1).detach().clamp_min(1e-30f);
    }
    torch::Tensor sums(int level, int out_size, const ZonalKernel& kernel) const {
        const Level& source = levels_[static_cast<std::size_t>(level)];
        return ZonalSum::apply(source.flux, source.solid_angles,
                               static_cast<std::int64_t>(out_size), kernel);
    }
    torch::Tensor multilevel_sums(int level, const ZonalKernel& kernel) const {
        const float near = near_texels * 2 / static_cast<float>(size(level));
        if (level + 1 == count() || near * near >= 0.7f * kernel.outer)
            return sums(level, size(level), kernel);
        const SplitKernel split = split_kernel(kernel, near * near);
        return sums(level, size(level), split.near) +
               UpsampleCube::apply(multilevel_sums(level + 1, split.rest));
    }
    std::vector<Level> levels_;
};

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

    const Pyramid pyramid(cube);
    int smallest = 0;
    while (pyramid.size(smallest) > smallest_size)
        ++smallest;
    EnvironmentLight light;
    light.diffuse = pyramid.mean(std::max(0, smallest - 1), diffuse_size, cosine_kernel());
    const auto add = [&](int level, float roughness) {
        light.specular.push_back(
            pyramid.multilevel_mean(level, ggx_kernel(roughness, kept_energy)));
        light.roughness.push_back(roughness);
    };
    // Two lobes a resolution: the shading blends neighbours, which shows when they are far apart.
    const int lobes = std::max(1, 2 * smallest);
    for (int lobe = 0; lobe < lobes; ++lobe)
        add(std::min(lobe / 2, smallest),
            finest_roughness * std::pow(chain_roughness / finest_roughness,
                                        static_cast<float>(lobe) / static_cast<float>(lobes)));
    for (const float roughness : wide_roughness)
        add(smallest, roughness);
    return light;
}

EnvironmentLight prefilter(const Image& equirectangular, int size, torch::Device device) {
    const torch::NoGradGuard no_gradient;
    torch::Tensor pixels = to_tensor(equirectangular);
    ITEM3D_CHECK(pixels.dim() == 3 && pixels.size(2) >= 3, "prefilter: an image of RGB radiance");
    return prefilter(equirectangular_to_cube(pixels.narrow(2, 0, 3), size)).to(device);
}

}  // namespace item3d
