#include "item3d/region/patch_vote.h"

#include "item3d/core/parallel.h"
#include "item3d/region/point_grid.h"
#include "item3d/region/surface_patches.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

/// Share of included points below which a patch is excluded, and above which it is included as a
/// whole.
constexpr double min_part = 0.25, largest_part = 0.75;
/// Share of the surface above which a patch is large. A large patch is cut along the points if its
/// included part is more than the share little_of_it of the surface, since a cup and its handle may
/// be one patch. Smaller patches are included whole if at least the share min_part of their points
/// is included.
constexpr double large_patch = 0.1, little_of_it = 0.005;

/// Interpolation of the values at visible points.
class PointField {
  public:
    PointField(const SurfaceReading& reading, const at::Tensor& value)
        : seen_(reading.seen.contiguous()),
          value_(value.contiguous()),
          grid_(reading.position, reading.spacing) {}

    /// Returns the mean of values around a position, weighted by proximity; -1 if no point is near.
    float at(Vec3 place) const {
        const bool* seen = seen_.const_data_ptr<bool>();
        const float* value = value_.const_data_ptr<float>();
        float sum = 0, weights = 0;
        grid_.for_each_near(place, [&](std::int64_t i, Vec3 point) {
            if (!seen[i]) return;
            const Vec3 apart = (point - place) / grid_.reach();
            const float weight = std::exp(-4 * glm::dot(apart, apart));
            sum += weight * value[i];
            weights += weight;
        });
        return weights > 1e-6f ? sum / weights : -1.0f;
    }

  private:
    at::Tensor seen_, value_;
    PointGrid grid_;
};

enum class Verdict : char { outside, inside, by_place };

class PatchSelector : public Selector {
  public:
    PatchSelector(SurfacePatches patches, std::vector<Verdict> verdicts, PointField field,
                  float threshold)
        : patches_(std::move(patches)),
          verdicts_(std::move(verdicts)),
          field_(std::move(field)),
          threshold_(threshold) {}

    at::Tensor weight(const Surface& surface) const override {
        const at::Tensor triangle = surface.triangle.cpu().contiguous();
        const at::Tensor position = surface.position.detach().cpu().contiguous();
        at::Tensor weights = at::zeros({triangle.size(0)}, at::kFloat);
        const std::int64_t* t = triangle.const_data_ptr<std::int64_t>();
        const float* p = position.const_data_ptr<float>();
        float* out = weights.data_ptr<float>();
        parallel_for(
            "region_patches", triangle.size(0),
            [&](std::int64_t i) {
                const int patch = patches_.of_triangle[static_cast<std::size_t>(t[i])];
                const Verdict verdict = verdicts_[static_cast<std::size_t>(patch)];
                if (verdict == Verdict::inside) out[i] = 1;
                if (verdict == Verdict::by_place)
                    out[i] = field_.at(Vec3(p[3 * i], p[3 * i + 1], p[3 * i + 2])) > threshold_;
            },
            512);
        return weights;
    }

  private:
    SurfacePatches patches_;
    std::vector<Verdict> verdicts_;
    PointField field_;
    float threshold_;
};

}  // namespace

PatchVote vote_by_patch(const RegionScene& scene, const SurfaceReading& reading,
                        const at::Tensor& value, float threshold) {
    PatchVote vote;
    vote.inside = reading.seen.logical_and(value.gt(threshold));
    SurfacePatches patches = find_patches(scene);
    const std::size_t count = patches.area.size();
    std::vector<double> seen(count, 0), named(count, 0);
    const std::int64_t* t = reading.triangle.const_data_ptr<std::int64_t>();
    const at::Tensor seen_points = reading.seen.contiguous();
    const bool* is_seen = seen_points.const_data_ptr<bool>();
    const bool* is_inside = vote.inside.const_data_ptr<bool>();
    const std::int64_t points = value.size(0);
    for (std::int64_t i = 0; i < points; ++i) {
        const auto patch =
            static_cast<std::size_t>(patches.of_triangle[static_cast<std::size_t>(t[i])]);
        seen[patch] += is_seen[i];
        named[patch] += is_inside[i];
    }
    const auto all = static_cast<double>(points);
    std::vector<Verdict> verdicts;
    for (std::size_t i = 0; i < count; ++i) {
        const double part = seen[i] > 0 ? named[i] / seen[i] : 0;
        const bool is_large = seen[i] > large_patch * all;
        const bool is_named = part >= min_part;
        const bool is_whole = part > largest_part || (is_named && !is_large);
        const bool is_cut = is_named || (is_large && named[i] > little_of_it * all);
        verdicts.push_back(is_whole ? Verdict::inside
                           : is_cut ? Verdict::by_place
                                    : Verdict::outside);
    }
    vote.taken = vote.inside.to(at::kFloat).mean().item<double>();
    if (vote.taken > 0) vote.mean = value.index({vote.inside}).mean().item<double>();
    vote.highest = value.masked_fill(reading.seen.logical_not(), 0).max().item<float>();
    vote.selector = std::make_unique<PatchSelector>(std::move(patches), std::move(verdicts),
                                                    PointField(reading, value), threshold);
    return vote;
}

}  // namespace item3d
