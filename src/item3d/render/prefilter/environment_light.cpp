// The prefiltered chain of split-sum lighting. Every step is linear in the environment.
//
//     P(n) = sum_l k(n.l) f(l) / sum_l k(n.l) w(l)        f = radiance w, w: solid angle of a texel
//
// for a kernel k for each lobe: GGX D(h) (n.l) of its roughness (kernels/zonal.h), and max(0, n.l)
// for irradiance over pi. Both sums are the same sum of 19 planes; w is the shared one.
//
//     flux    512  ->  256  ->  128  ->  64  ->  32  ->  16        restricted(), U^T
//     lobe    near     near     near     near    far              kernel split at each level
//     sums    512  <-  256  <-  128  <-  64  <-  32               upsampled(), U
//
// A lobe begins at a level of its own and ends at its last one (32 texels, wide ones 16), where the
// rest of its kernel is summed over all pairs of texels. The rest that a level hands on continues
// inwards as a parabola in the squared chord d with the kernel's value, slope and bend there, so
// it is smooth at n = l. Cost for n texels: n times the near taps, a third more for all coarser
// levels, and a constant at the end, at most (6 32^2)^2 pairs.
//
// Backward: all sums are symmetric and restriction is the transpose of upsampling, so the gradient
// of the sums goes down the same way (near sums on each level, far sums on the last), and up by U
// to f.
#include "item3d/render/prefilter/environment_light.h"

#include "item3d/core/error.h"
#include "item3d/render/checks.h"
#include "item3d/render/dispatch.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/prefilter/equirectangular.h"
#include "item3d/render/prefilter/irradiance_sums.h"
#include "item3d/render/prefilter/specular_sums.h"

#include <torch/csrc/autograd/custom_function.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace item3d {
namespace {

using kernels::row_tile;
using kernels::ZonalKernel;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

constexpr int coarsest_size = 16;                  ///< size of the map for far texels
constexpr int min_size = 16, largest_size = 1024;  ///< range of an environment's size
/// Roughness of the sharpest lobe: a lower one wants more texels and another lobe.
constexpr float finest_roughness = 0.08f;
constexpr float chain_roughness = 0.5f;  ///< first lobe of the smallest level
/// Number of lobes between these two, by the difference to the exact split sum of smooth metal
/// (docs/renderer.md); more cost time and memory.
constexpr std::size_t narrow_lobes = 8;
/// Three lobes to an octave of roughness.
constexpr std::array<float, 4> coarsest_roughness = {chain_roughness, 0.63f, 0.79f, 1.0f};
/// Roughness from which lobes lose nothing on the map of 16 texels; narrower ones end at 32, by
/// time against the difference to direct sums (docs/journal/benchmarks.md).
constexpr float wide = 0.3f;
/// Share of a lobe's half vectors that is summed: the tail beyond costs texels for little light.
constexpr float kept_energy = 0.999f;
/// Radius of near sums on a lobe's own map and on coarser maps, in texels at a face's centre; the
/// next map sums the rest. A lobe is smooth where its own map hands over; on coarser maps its tail
/// decreases with distance, and so does the error with the radius in texels. By time against the
/// difference to direct sums (docs/journal/benchmarks.md).
constexpr float near_texels = 1.5f, near_texels_coarser = 3;

/// Returns exact solid angles of a face's texels, [size, size].
at::Tensor texel_solid_angles(int size, at::Device device) {
    // Solid angle of the rectangle from the face's centre to a texel's corner; by symmetry an
    // eighth of the face suffices.
    const int half = size / 2;
    std::vector<double> corner(static_cast<std::size_t>(half + 1) * (half + 1));
    const auto at = [&](int y, int x) -> double& {
        return corner[static_cast<std::size_t>(y) * (half + 1) + x];
    };
    for (int y = 0; y <= half; ++y) {
        for (int x = 0; x <= y; ++x) {
            const double s = static_cast<double>(x) / half, t = static_cast<double>(y) / half;
            at(y, x) = at(x, y) = std::atan2(s * t, std::sqrt(s * s + t * t + 1));
        }
    }
    at::Tensor angles = at::empty({size, size});
    float* out = angles.data_ptr<float>();
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column) {
            const int y = row < half ? half - 1 - row : row - half;
            const int x = column < half ? half - 1 - column : column - half;
            *out++ = static_cast<float>(at(y + 1, x + 1) - at(y, x + 1) - at(y + 1, x) + at(y, x));
        }
    return angles.to(device);
}

/// energy: kept share of the lobe's half vectors, below 1.
ZonalKernel ggx_kernel(float roughness, float energy) {
    ZonalKernel kernel{};
    const float alpha = roughness * roughness;
    kernel.alpha2 = alpha * alpha;
    // D(h) (n.h) has the cumulative distribution tan^2 / (alpha^2 + tan^2).
    const float tangent = alpha * std::sqrt(energy / (1 - energy));
    const float sine = std::sin(std::atan(tangent));
    kernel.outer = std::min(2.0f, 4 * sine * sine);
    kernel.floor = kernel.profile(kernel.outer);
    return kernel;
}

struct SplitKernel {
    ZonalKernel near, rest;
};

/// Splits GGX at the squared chord `at`: the rest continues inwards as a parabola with the kernel's
/// value, first and second derivative at that point.
SplitKernel split_kernel(const ZonalKernel& kernel, float at) {
    const double a = static_cast<double>(kernel.alpha2) - 1, d = at, c = 1 - 0.5 * d;
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

/// Summation plan of a lobe: near texels on its own and coarser levels, the rest on the last.
struct Lobe {
    float roughness;
    std::size_t level;
    std::vector<ZonalKernel> near;
    ZonalKernel far;
    std::size_t last() const { return level + near.size(); }
};

Lobe plan_lobe(float roughness, int size, std::size_t level, std::size_t last) {
    Lobe lobe{roughness, level, {}, ggx_kernel(roughness, kept_energy)};
    for (; lobe.last() < last; size /= 2) {
        const float texels = lobe.near.empty() ? near_texels : near_texels_coarser;
        const float near = texels * 2 / static_cast<float>(size);
        // The rest of a lobe that hardly reaches further is not worth a level.
        if (near * near >= 0.7f * lobe.far.outer) break;
        const SplitKernel split = split_kernel(lobe.far, near * near);
        lobe.near.push_back(split.near);
        lobe.far = split.rest;
    }
    return lobe;
}

struct Plan {
    std::vector<int> sizes;   ///< resolutions of the environment, finest first
    std::vector<Lobe> lobes;  ///< one for each level of EnvironmentLight
    std::size_t cosine = 0;   ///< level for irradiance, at most 128 texels
};

Plan plan_chain(int size) {
    Plan plan;
    for (; size >= coarsest_size; size /= 2)
        plan.sizes.push_back(size);
    const std::size_t levels = plan.sizes.size();
    const std::size_t smallest = levels > 1 ? levels - 2 : 0;  // 32 texels
    while (plan.sizes[plan.cosine] > irradiance_size)
        ++plan.cosine;
    const auto add = [&](float roughness, std::size_t level) {
        plan.lobes.push_back(plan_lobe(roughness, plan.sizes[level], level,
                                       roughness < wide ? smallest : levels - 1));
    };
    const std::size_t lobes = smallest > 0 ? narrow_lobes : 1;
    for (std::size_t i = 0; i < lobes; ++i)
        add(finest_roughness * std::pow(chain_roughness / finest_roughness,
                                        static_cast<float>(i) / static_cast<float>(lobes)),
            i * smallest / lobes);
    for (const float roughness : coarsest_roughness)
        add(roughness, smallest);
    return plan;
}

/// Lazily computed directions of a plan's levels.
class LevelDirections {
  public:
    LevelDirections(const Plan& plan, at::Device device)
        : sizes_(plan.sizes), levels_(sizes_.size()), device_(device) {}
    const CubeDirections& at(std::size_t level) {
        if (!levels_[level]) levels_[level].emplace(sizes_[level], device_);
        return *levels_[level];
    }

  private:
    std::vector<int> sizes_;
    std::vector<std::optional<CubeDirections>> levels_;
    at::Device device_;
};

/// Mean radiance of each texel: sums of radiance over sums of solid angle.
struct MeanRadiance {
    at::Tensor mean;            ///< [6, S, S, 3]
    at::Tensor inverse_weight;  ///< [S, S], the same for each face
    MeanRadiance(int size, const at::TensorOptions& options)
        : mean(at::empty({6, size, size, 3}, options)),
          inverse_weight(at::empty({size, size}, options)) {}
    explicit MeanRadiance(const CubePlanes& sums) : MeanRadiance(sums.size(), sums.options()) {
        kernels::MeansParameters p = parameters();
        p.sums = sums.view();
        p.length = run_length(sums.device(), sums.size());
        dispatch<kernels::planes_to_means>(
            sums.device(), "planes_to_means", &cuda::RenderTable::planes_to_means, p,
            static_cast<std::int64_t>(sums.size()) * (sums.size() / p.length), 16);
    }
    kernels::MeansParameters parameters() const {
        kernels::MeansParameters p{};
        p.map = mean.data_ptr<float>();
        p.inverse_weight = inverse_weight.data_ptr<float>();
        p.sums.size = static_cast<int>(mean.size(1));
        return p;
    }
};

/// Returns the kernel's sums plus the upsampled `coarse`, of half the size with a filled halo.
CubePlanes finer_sums(const CubePlanes& source, const CubeDirections& directions,
                      const ZonalKernel& kernel, const CubePlanes& coarse) {
    if (source.device().is_cuda()) {
        CubePlanes sums = upsampled(coarse);
        add_near_sums(source, directions, kernel, sums);
        return sums;
    }
    CubePlanes sums(source.size(), source.shared_plane(), source.device());
    const kernels::Planes out = sums.writable();
    near_sums(source, directions, kernel, &coarse, [&](int row, int column, const float* values) {
        for (int plane = 0; plane < out.count; ++plane)
            std::copy_n(values + plane * row_tile, row_tile, out.row(plane, row) + column);
    });
    return sums;
}

/// Returns the means of these sums. On the CPU the sums are never in memory all at once.
MeanRadiance finest_means(const CubePlanes& source, const CubeDirections& directions,
                          const ZonalKernel& kernel, const CubePlanes& coarse) {
    if (source.device().is_cuda())
        return MeanRadiance(finer_sums(source, directions, kernel, coarse));
    const MeanRadiance map(source.size(), source.options());
    const kernels::MeansParameters p = map.parameters();
    near_sums(source, directions, kernel, &coarse, [&](int row, int column, const float* values) {
        kernels::store_means(p, {0, row, column, column + row_tile}, values, row_tile);
    });
    return map;
}

/// Adds the kernel's sums to planes of the same size.
void add_sums(const CubePlanes& source, const CubeDirections& directions, const ZonalKernel& kernel,
              CubePlanes& to) {
    if (source.device().is_cuda()) {
        add_near_sums(source, directions, kernel, to);
        return;
    }
    const kernels::Planes out = to.writable();
    near_sums(source, directions, kernel, nullptr, [&](int row, int column, const float* values) {
        for (int plane = 0; plane < out.count; ++plane) {
            float* __restrict sums = out.row(plane, row) + column;
            for (int x = 0; x < row_tile; ++x)
                sums[x] += values[plane * row_tile + x];
        }
    });
}

/// Maps a cube [6, S, S, 3] to the irradiance map and one map for each lobe.
struct Prefilter : torch::autograd::Function<Prefilter> {
    static tensor_list forward(AutogradContext* context, const at::Tensor& cube) {
        const Plan plan = plan_chain(static_cast<int>(cube.size(1)));
        // Radiance times solid angle; solid angle in the shared plane.
        std::vector<CubePlanes> flux;
        flux.push_back(
            to_planes(cube, texel_solid_angles(plan.sizes.front(), cube.device()), true));
        while (flux.size() < plan.sizes.size())
            flux.push_back(restricted(flux.back()));
        LevelDirections directions(plan, cube.device());
        tensor_list maps, weights;
        const auto keep = [&](const MeanRadiance& map) {
            maps.push_back(map.mean);
            weights.push_back(map.inverse_weight);
        };
        const at::Tensor bright = bright_texels(flux[plan.cosine]);
        keep(MeanRadiance(irradiance_sums(flux[plan.cosine], bright)));
        for (const Lobe& lobe : plan.lobes) {
            CubePlanes sums = far_sums(flux[lobe.last()], lobe.far);
            for (std::size_t level = lobe.last(); level-- > lobe.level + 1;) {
                fill_halo(sums, 1);
                sums = finer_sums(flux[level], directions.at(level), lobe.near[level - lobe.level],
                                  sums);
            }
            if (lobe.near.empty()) {
                keep(MeanRadiance(sums));
                continue;
            }
            fill_halo(sums, 1);
            keep(
                finest_means(flux[lobe.level], directions.at(lobe.level), lobe.near.front(), sums));
        }
        context->set_materialize_grads(false);
        context->saved_data["weights"] = weights;
        context->saved_data["size"] = cube.size(1);
        context->saved_data["bright"] = bright;
        return maps;
    }

    /// Applies the transposes in reverse order; the sums are symmetric.
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const auto size = static_cast<int>(context->saved_data["size"].toInt());
        const Plan plan = plan_chain(size);
        const std::vector<at::Tensor> weights = context->saved_data["weights"].toTensorVector();
        const at::Device device = weights.front().device();
        std::vector<CubePlanes> flux;
        LevelDirections directions(plan, device);
        for (const int level_size : plan.sizes) {
            flux.emplace_back(level_size, false, device);
            flux.back().clear();
        }
        if (gradients[0].defined())
            flux[plan.cosine].add(irradiance_sums_transposed(
                to_planes(gradients[0], weights[0], false), plan.sizes[plan.cosine],
                context->saved_data["bright"].toTensor()));
        for (std::size_t i = 0; i < plan.lobes.size(); ++i) {
            if (!gradients[i + 1].defined()) continue;
            const Lobe& lobe = plan.lobes[i];
            CubePlanes sums = to_planes(gradients[i + 1], weights[i + 1], false);
            for (std::size_t level = lobe.level; level < lobe.last(); ++level) {
                add_sums(sums, directions.at(level), lobe.near[level - lobe.level], flux[level]);
                sums = restricted(sums);
            }
            flux[lobe.last()].add(far_sums(sums, lobe.far));
        }
        for (std::size_t level = flux.size() - 1; level-- > 0;) {
            fill_halo(flux[level + 1], 1);
            add_upsampled(flux[level], flux[level + 1]);
        }
        return {from_planes(flux[0], texel_solid_angles(size, device))};
    }
};

}  // namespace

EnvironmentLight EnvironmentLight::to(at::Device device) const {
    EnvironmentLight moved{diffuse.to(device), {}, roughness};
    for (const at::Tensor& level : specular)
        moved.specular.push_back(level.to(device));
    return moved;
}

EnvironmentLight prefilter(const at::Tensor& cube_) {
    const at::Tensor cube = checked("prefilter", "cube", cube_, at::kFloat, {6, -1, -1, 3},
                                    operation_device("prefilter", cube_));
    const int size = static_cast<int>(cube.size(1));
    ITEM3D_CHECK(cube.size(2) == size && size >= min_size && size <= largest_size &&
                     (size & (size - 1)) == 0,
                 "prefilter: cube must be [6, S, S, 3] with S a power of two in [16, 1024], found "
                 "S = " +
                     std::to_string(size) + " and " + std::to_string(cube.size(2)));

    const tensor_list maps = Prefilter::apply(cube);
    EnvironmentLight light{maps[0], {maps.begin() + 1, maps.end()}, {}};
    for (const Lobe& lobe : plan_chain(size).lobes)
        light.roughness.push_back(lobe.roughness);
    return light;
}

EnvironmentLight prefilter(const Image& equirectangular, int size, at::Device device) {
    const at::NoGradGuard no_gradient;
    at::Tensor pixels = to_tensor(equirectangular);
    ITEM3D_CHECK(pixels.dim() == 3 && pixels.size(2) >= 3, "prefilter: an image of RGB radiance");
    return prefilter(equirectangular_to_cube(pixels.narrow(2, 0, 3).to(device), size));
}

}  // namespace item3d
