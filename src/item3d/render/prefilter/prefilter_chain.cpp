// The prefiltered chain of split-sum lighting. Every step is linear in the environment.
//
//     P(n) = sum_l k(n.l) f(l) / sum_l k(n.l) w(l)        f = radiance w, w: solid angle of a texel
//
// with a kernel k for each lobe: GGX D(h) (n.l) at its roughness (kernels/zonal.h), or max(0, n.l)
// for irradiance over pi. Numerator and denominator are computed together, as sums over 19 planes,
// of which w is the shared plane.
//
//     flux    512  ->  256  ->  128  ->  64  ->  32  ->  16        restricted(), U^T
//     lobe    near     near     near     near    far              kernel split at each level
//     sums    512  <-  256  <-  128  <-  64  <-  32               upsampled(), U
//
// A lobe begins at a level of its own and ends at its last level, which has 32 texels, or 16 for a
// wide lobe. On the last level the rest of its kernel is summed over all pairs of texels. Within
// the near radius of a level, the rest for the next level is a parabola in the squared chord d,
// with the kernel's value and first two derivatives at that radius, so it is smooth at n = l. For N
// texels, the cost is N times the number of near texels, a third more for all coarser levels, and
// at most (6 32^2)^2 pairs at the end.
//
// Backward: all sums are symmetric, and restriction is the transpose of upsampling. So the gradient
// of the sums passes through the same steps: near sums on each level, far sums on the last level,
// then U up to f.
#include "item3d/render/prefilter/prefilter_chain.h"

#include "item3d/render/prefilter/specular_sums.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace item3d {
namespace {

using kernels::row_tile;
using kernels::ZonalKernel;

/// Returns exact solid angles of a face's texels, [size, size].
std::vector<float> texel_solid_angles(int size) {
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
    std::vector<float> angles(static_cast<std::size_t>(size) * size);
    float* out = angles.data();
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column) {
            const int y = row < half ? half - 1 - row : row - half;
            const int x = column < half ? half - 1 - column : column - half;
            *out++ = static_cast<float>(at(y + 1, x + 1) - at(y, x + 1) - at(y + 1, x) + at(y, x));
        }
    return angles;
}

/// Directions of a plan's levels, each computed on first use.
class LevelDirections {
  public:
    LevelDirections(const ChainPlan& plan, const PrefilterBackend& backend)
        : sizes_(plan.sizes), levels_(sizes_.size()), backend_(backend) {}
    const CubeDirections& at(std::size_t level) {
        if (!levels_[level]) levels_[level].emplace(sizes_[level], backend_);
        return *levels_[level];
    }

  private:
    std::vector<int> sizes_;
    std::vector<std::optional<CubeDirections>> levels_;
    const PrefilterBackend& backend_;
};

kernels::MeansParameters means_parameters(const MeanMap& map) {
    kernels::MeansParameters p{};
    p.map = map.mean;
    p.inverse_weight = map.inverse_weight;
    p.sums.size = map.size;
    return p;
}

/// Sets the means: sums of radiance divided by sums of solid angle.
void set_means(const CubePlanes& sums, const MeanMap& map) {
    kernels::MeansParameters p = means_parameters(map);
    p.sums = sums.view();
    p.length = run_length(sums.backend(), sums.size());
    run_kernel<kernels::planes_to_means>(
        sums.backend(), "planes_to_means", &cuda::RenderTable::planes_to_means, p,
        static_cast<std::int64_t>(sums.size()) * (sums.size() / p.length), 16);
}

/// Returns the kernel's sums plus the upsampled `coarse`, which has half the size and a filled
/// halo.
CubePlanes finer_sums(const CubePlanes& source, const CubeDirections& directions,
                      const ZonalKernel& kernel, const CubePlanes& coarse) {
    if (source.backend().on_device()) {
        CubePlanes sums = upsampled(coarse);
        add_near_sums(source, directions, kernel, sums);
        return sums;
    }
    CubePlanes sums(source.size(), source.shared_plane(), source.backend());
    const kernels::Planes out = sums.writable();
    near_sums(source, directions, kernel, &coarse, [&](int row, int column, const float* values) {
        for (int plane = 0; plane < out.count; ++plane)
            std::copy_n(values + plane * row_tile, row_tile, out.row(plane, row) + column);
    });
    return sums;
}

/// Sets the means of finer_sums(). On the CPU the sums are never in memory all at once.
void set_finest_means(const CubePlanes& source, const CubeDirections& directions,
                      const ZonalKernel& kernel, const CubePlanes& coarse, const MeanMap& map) {
    if (source.backend().on_device()) {
        set_means(finer_sums(source, directions, kernel, coarse), map);
        return;
    }
    const kernels::MeansParameters p = means_parameters(map);
    near_sums(source, directions, kernel, &coarse, [&](int row, int column, const float* values) {
        kernels::store_means(p, {0, row, column, column + row_tile}, values, row_tile);
    });
}

/// Adds the kernel's sums to planes of the same size.
void add_sums(const CubePlanes& source, const CubeDirections& directions, const ZonalKernel& kernel,
              CubePlanes& to) {
    if (source.backend().on_device()) {
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

}  // namespace

void prefilter_forward(const PrefilterBackend& backend, const ChainPlan& plan,
                       const CubeMap& environment, const std::vector<MeanMap>& maps,
                       std::int64_t* bright) {
    // The flux is radiance times solid angle. Its shared plane is the solid angle.
    std::vector<CubePlanes> flux;
    const Floats angles = backend.upload(texel_solid_angles(plan.sizes.front()));
    flux.push_back(to_planes(environment, angles.get(), true, backend));
    while (flux.size() < plan.sizes.size())
        flux.push_back(restricted(flux.back()));
    LevelDirections directions(plan, backend);
    bright_texels(flux[plan.cosine], bright);
    set_means(irradiance_sums(flux[plan.cosine], bright), maps[0]);
    for (std::size_t i = 0; i < plan.lobes.size(); ++i) {
        const Lobe& lobe = plan.lobes[i];
        CubePlanes sums = far_sums(flux[lobe.last()], lobe.far);
        for (std::size_t level = lobe.last(); level-- > lobe.level + 1;) {
            fill_halo(sums, 1);
            sums =
                finer_sums(flux[level], directions.at(level), lobe.near[level - lobe.level], sums);
        }
        if (lobe.near.empty()) {
            set_means(sums, maps[i + 1]);
            continue;
        }
        fill_halo(sums, 1);
        set_finest_means(flux[lobe.level], directions.at(lobe.level), lobe.near.front(), sums,
                         maps[i + 1]);
    }
}

void prefilter_backward(const PrefilterBackend& backend, const ChainPlan& plan,
                        const std::vector<MeanGradient>& gradients, const std::int64_t* bright,
                        float* environment_gradient) {
    // The transposes of the forward steps run in reverse order. Sums are their own transposes.
    std::vector<CubePlanes> flux;
    LevelDirections directions(plan, backend);
    for (const int size : plan.sizes) {
        flux.emplace_back(size, false, backend);
        flux.back().clear();
    }
    const auto planes_of = [&](const MeanGradient& map) {
        return to_planes(map.gradient, map.inverse_weight, false, backend);
    };
    if (gradients[0].gradient.values != nullptr)
        flux[plan.cosine].add(
            irradiance_sums_transposed(planes_of(gradients[0]), plan.sizes[plan.cosine], bright));
    for (std::size_t i = 0; i < plan.lobes.size(); ++i) {
        if (gradients[i + 1].gradient.values == nullptr) continue;
        const Lobe& lobe = plan.lobes[i];
        CubePlanes sums = planes_of(gradients[i + 1]);
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
    const Floats angles = backend.upload(texel_solid_angles(plan.sizes.front()));
    from_planes(flux[0], angles.get(), environment_gradient);
}

}  // namespace item3d
