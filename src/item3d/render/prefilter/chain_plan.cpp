#include "item3d/render/prefilter/chain_plan.h"

#include "item3d/render/kernels/irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace item3d {
namespace {

using kernels::ZonalKernel;

constexpr int coarsest_size = 16;  ///< size of the smallest map
/// Roughness of the sharpest lobe. A sharper one would need more texels and one more lobe.
constexpr float finest_roughness = 0.08f;
constexpr float chain_roughness = 0.5f;  ///< roughness of the first lobe at 32 texels
/// Number of lobes from finest_roughness up to chain_roughness. The number was chosen by the
/// difference from the exact split sum on smooth metal (docs/renderer.md). More lobes cost time and
/// memory.
constexpr std::size_t narrow_lobes = 8;
/// The roughness of the last lobes. It doubles every three lobes.
constexpr std::array<float, 4> coarsest_roughness = {chain_roughness, 0.63f, 0.79f, 1.0f};
/// Minimum roughness of lobes that end at the map of 16 texels, where such lobes lose nothing.
/// Sharper lobes end at the map of 32 texels. The value was chosen by time and by the difference
/// from direct sums (docs/journal/benchmarks.md).
constexpr float wide = 0.3f;
/// Share of a lobe's half vectors that is summed. The omitted tail would cost many texels for
/// little light.
constexpr float kept_energy = 0.999f;
/// Radius of near sums on a lobe's own map and on coarser maps, in texels at a face's centre. The
/// next coarser map sums the rest of the lobe. On its own map a lobe is smooth at this radius. On
/// coarser maps the lobe's tail decreases with distance, so a larger radius has a smaller error.
/// Both values were chosen by time and by the difference from direct sums
/// (docs/journal/benchmarks.md).
constexpr float near_texels = 1.5f, near_texels_coarser = 3;

/// Returns the zonal kernel of GGX. energy: share of the lobe's half vectors that is kept, below 1.
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

/// Splits GGX at the squared chord `at` into a near kernel and the rest. Below `at`, the rest is a
/// parabola with the kernel's value, first and second derivative at that point.
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

Lobe plan_lobe(float roughness, int size, std::size_t level, std::size_t last) {
    Lobe lobe{roughness, level, {}, ggx_kernel(roughness, kept_energy)};
    for (; lobe.last() < last; size /= 2) {
        const float texels = lobe.near.empty() ? near_texels : near_texels_coarser;
        const float near = texels * 2 / static_cast<float>(size);
        if (near * near >= 0.7f * lobe.far.outer) break;
        const SplitKernel split = split_kernel(lobe.far, near * near);
        lobe.near.push_back(split.near);
        lobe.far = split.rest;
    }
    return lobe;
}

}  // namespace

ChainPlan plan_chain(int size) {
    ChainPlan plan;
    for (; size >= coarsest_size; size /= 2)
        plan.sizes.push_back(size);
    const std::size_t levels = plan.sizes.size();
    const std::size_t smallest = levels > 1 ? levels - 2 : 0;  // 32 texels
    while (plan.sizes[plan.cosine] > kernels::irradiance_size)
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

}  // namespace item3d
