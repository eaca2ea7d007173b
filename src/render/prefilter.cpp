// The prefiltered chain of split-sum lighting. Every step is linear in the environment.

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/render/checks.h"
#include "item3d/render/environment_light.h"
#include "item3d/render/kernels/zonal.h"
#include "item3d/render/shade.h"

#include <torch/csrc/autograd/custom_function.h>

#include <cmath>

namespace item3d {
namespace {

using kernels::ZonalKernel;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

constexpr int smallest_size = 16;
constexpr float finest_roughness = 0.08f;
constexpr float chain_roughness = 0.5f;

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
    return {true, 0, 0, 0.5f * pi};
}

/// energy: the share of the lobe's half vectors that is kept, below 1.
ZonalKernel ggx_kernel(float roughness, float energy) {
    ZonalKernel kernel{};
    const float alpha = roughness * roughness;
    kernel.alpha2_1 = alpha * alpha - 1;
    // D(h) (n.h) has the cumulative distribution tan^2 / (alpha^2 + tan^2).
    const float tangent = alpha * std::sqrt(energy / (1 - energy));
    kernel.cut_angle = std::min(2 * std::atan(tangent), 0.5f * pi);
    kernel.floor = kernel.profile<false>(std::max(0.0f, std::cos(kernel.cut_angle)));
    return kernel;
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

/// flux [6, S, S, 3] (radiance times solid angle) -> mean radiance under the kernel [6, R, R, 3].
struct ZonalMean : torch::autograd::Function<ZonalMean> {
    static torch::Tensor forward(AutogradContext* context, const torch::Tensor& flux,
                                 const torch::Tensor& solid_angles, std::int64_t out_size,
                                 const ZonalKernel& kernel) {
        const torch::Tensor sums =
            zonal_sums(to_planes(flux, solid_angles), static_cast<int>(out_size), kernel);
        const torch::Tensor norm = sums.narrow(3, 3, 1).clamp_min(1e-30f);
        context->save_for_backward({norm});
        context->saved_data["size"] = flux.size(1);
        context->saved_data["kernel"] = std::vector<double>{
            kernel.cosine ? 1.0 : 0.0, kernel.alpha2_1, kernel.floor, kernel.cut_angle};
        return sums.narrow(3, 0, 3) / norm;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const std::vector<double> k = context->saved_data["kernel"].toDoubleVector();
        const ZonalKernel kernel{k[0] != 0, static_cast<float>(k[1]), static_cast<float>(k[2]),
                                 static_cast<float>(k[3])};
        const torch::Tensor scaled = gradients[0] / context->get_saved_variables()[0];
        const torch::Tensor sums =
            zonal_sums(to_planes(scaled, torch::zeros({1})),
                       static_cast<int>(context->saved_data["size"].toInt()), kernel);
        return {sums.narrow(3, 0, 3).contiguous(), torch::Tensor(), torch::Tensor(),
                torch::Tensor()};
    }
};

/// The environment at one resolution.
struct Flux {
    torch::Tensor color;         ///< [6, S, S, 3]
    torch::Tensor solid_angles;  ///< [S, S]
    int size() const { return static_cast<int>(color.size(1)); }
    Flux halved() const {
        const std::int64_t half = size() / 2;
        return {color.reshape({6, half, 2, half, 2, 3}).sum({2, 4}),
                solid_angles.reshape({half, 2, half, 2}).sum({1, 3})};
    }
    torch::Tensor mean(int out_size, const ZonalKernel& kernel) const {
        return ZonalMean::apply(color, solid_angles, static_cast<std::int64_t>(out_size), kernel);
    }
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
    ITEM3D_CHECK(cube.size(2) == size && size >= smallest_size && (size & (size - 1)) == 0,
                 "prefilter: cube must be [6, S, S, 3] with S a power of two of at least 16, found "
                 "S = " +
                     std::to_string(size) + " and " + std::to_string(cube.size(2)));

    const torch::Tensor solid_angles = texel_solid_angles(size);
    std::vector<Flux> chain{{cube * solid_angles.unsqueeze(-1), solid_angles}};
    while (chain.back().size() > smallest_size)
        chain.push_back(chain.back().halved());
    const int levels = static_cast<int>(chain.size());
    // Wide kernels read a level twice as fine as what they write, so that the source's texels blur
    // them little.
    const Flux& wide = chain[static_cast<std::size_t>(std::max(0, levels - 2))];

    EnvironmentLight light;
    light.diffuse = wide.mean(smallest_size, cosine_kernel());
    for (int level = 0; level < levels; ++level) {
        const Flux& flux = chain[static_cast<std::size_t>(level)];
        const float roughness = levels == 1
                                    ? finest_roughness
                                    : finest_roughness + (chain_roughness - finest_roughness) *
                                                             static_cast<float>(level) /
                                                             static_cast<float>(levels - 1);
        // Large levels have narrow lobes, whose faint tails cost most of the time.
        const float energy = flux.size() > 64 ? 0.97f : 0.99f;
        light.specular.push_back(
            (level == levels - 1 ? wide : flux).mean(flux.size(), ggx_kernel(roughness, energy)));
        light.roughness.push_back(roughness);
    }
    light.specular.push_back(wide.mean(smallest_size, ggx_kernel(1.0f, 0.9999f)));
    light.roughness.push_back(1.0f);
    return light;
}

EnvironmentLight prefilter(const Image& equirectangular, int size, torch::Device device) {
    const torch::NoGradGuard no_gradient;
    torch::Tensor pixels = to_tensor(equirectangular);
    ITEM3D_CHECK(pixels.dim() == 3 && pixels.size(2) >= 3, "prefilter: an image of RGB radiance");
    return prefilter(equirectangular_to_cube(pixels.narrow(2, 0, 3), size)).to(device);
}

}  // namespace item3d
