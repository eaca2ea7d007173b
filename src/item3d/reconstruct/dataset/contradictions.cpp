#include "item3d/reconstruct/dataset/contradictions.h"

#include "item3d/core/parallel.h"
#include "item3d/reconstruct/shape/visual_hull.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

namespace item3d {

namespace {

constexpr int longest_small_side = 256;
constexpr int coarse_vote_cells = 32;
constexpr int fine_vote_cells = 48;
constexpr std::size_t rays_of_view = 128;
/// Margin in cells. It is the sum of half a cube's diagonal, half a step along a ray, and a
/// tolerance for inexact poses.
constexpr float vote_margin = 1.3f;
/// VisualHull::distance() exceeds this value at points that no view shows.
constexpr float not_shown = 1e11f;
/// Minimum blame for which a view is removed, as a fraction of `rays_of_view`.
constexpr double min_blame = 0.05;
/// Maximum fraction of the contradictions that may remain after the contradicting views are
/// removed.
constexpr double unsolved_part = 1.0 / 3;
/// Minimum fraction of contradicting rays that is reported if no contradicting view is found.
/// Smaller fractions come from inexact poses.
constexpr double min_unsolved = 0.01;
/// Minimum coverage of a pixel that surely shows the object, and of a pixel that may show it.
constexpr float surely_object = 0.6f, perhaps_object = 0.1f;

/// Returns the widest possible outline: every pixel with some coverage is inside.
Photograph wide_outline(const Photograph& mask) {
    Photograph wide{mask.name, mask.camera, Image(mask.image.width, mask.image.height, 1)};
    for (std::size_t i = 0; i < wide.image.pixels.size(); ++i)
        wide.image.pixels[i] = mask.image.pixels[2 * i + 1] > perhaps_object ? 1.0f : 0.0f;
    return wide;
}

struct ObjectRay {
    std::size_t view;
    Vec3 eye, direction;
};

/// Adds rays through some pixels of the object, evenly chosen.
void add_object_rays(const Photograph& view, std::size_t index, std::vector<ObjectRay>& rays) {
    const Image& image = view.image;
    std::vector<Vec2> pixels;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (image.at(x, y, 0) >= surely_object)
                pixels.emplace_back(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    const float half_width = 0.5f * static_cast<float>(image.width);
    const float focal = half_width / std::tan(0.5f * view.camera.field_of_view_x);
    const Mat3 rotation(view.camera.camera_to_world);
    const std::size_t count = std::min(rays_of_view, pixels.size());
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2 pixel = pixels[(2 * i + 1) * pixels.size() / (2 * count)];
        const Vec3 seen((pixel.x - half_width) / focal,
                        (0.5f * static_cast<float>(image.height) - pixel.y) / focal, -1);
        rays.push_back({index, view.camera.position(), rotation * glm::normalize(seen)});
    }
}

/// Set of views as bits.
using ViewSet = std::vector<std::uint64_t>;

bool holds_view(std::span<const std::uint64_t> set, std::size_t view) {
    return (set[view / 64] >> (view % 64) & 1) != 0;
}

/// Votes of the views: the views that exclude each lattice point, and the lattice points along each
/// ray.
class OutlineVotes {
  public:
    OutlineVotes(const std::vector<VisualHull>& outlines, const std::vector<ObjectRay>& rays,
                 const Lattice& lattice);

    /// Returns a box around the points that at most a quarter of the views that show them exclude.
    std::array<Vec3, 2> likely_bounds() const;

    void set_active(std::size_t view, bool is_active);
    /// Returns the number of rays of active views along which no point is allowed by all active
    /// views.
    std::size_t contradicting_rays() const;
    /// Returns the number of contradicting rays of one view, whether the view is active or not.
    std::size_t contradicting_rays(std::size_t view) const;
    std::size_t active_rays() const;
    /// Returns the number of rays along which no point is both allowed by all views and shown by
    /// half of the views.
    std::size_t unsupported_rays() const;
    /// Returns the number of rays that each view is blamed for. A contradicting ray is the fault of
    /// its own view, or of the views that exclude the least excluded point on the ray. The fewer
    /// these views are, the more blame they share.
    std::vector<double> blame() const;

  private:
    std::span<const std::uint64_t> excluders(std::size_t point) const {
        return {excluders_.data() + point * words_, words_};
    }
    void trace(const ObjectRay& ray);
    /// Returns the minimum, over the points of the ray, of the number of active views that exclude
    /// the point, and a point with this minimum.
    std::pair<int, std::size_t> fewest_excluders(std::size_t ray) const;

    Lattice lattice_;
    std::size_t view_count_;
    std::size_t words_;
    std::vector<std::uint64_t> excluders_;  ///< [points, words_]
    std::vector<std::uint16_t> shown_;      ///< number of views that show each point
    std::vector<std::uint16_t> excluded_;   ///< number of active views that exclude each point
    ViewSet active_;
    std::vector<std::size_t> ray_view_;
    std::vector<std::size_t> ray_begin_;  ///< start in ray_points_; one more entry than rays
    std::vector<std::uint32_t> ray_points_;
};

OutlineVotes::OutlineVotes(const std::vector<VisualHull>& outlines,
                           const std::vector<ObjectRay>& rays, const Lattice& lattice)
    : lattice_(lattice),
      view_count_(outlines.size()),
      words_((outlines.size() + 63) / 64),
      active_(words_, 0) {
    const auto count = static_cast<std::size_t>(lattice.vertex_count());
    excluders_.assign(count * words_, 0);
    shown_.assign(count, 0);
    excluded_.assign(count, 0);
    const at::Tensor points = lattice.vertices();
    for (std::size_t view = 0; view < outlines.size(); ++view) {
        const at::Tensor distances = outlines[view].distance(points);
        const float* distance = distances.const_data_ptr<float>();
        for (std::size_t point = 0; point < count; ++point) {
            if (distance[point] > not_shown) continue;
            ++shown_[point];
            if (distance[point] > vote_margin * lattice.cell)
                excluders_[point * words_ + view / 64] |= std::uint64_t{1} << (view % 64);
        }
        set_active(view, true);
    }
    ray_begin_.push_back(0);
    for (const ObjectRay& ray : rays)
        trace(ray);
}

void OutlineVotes::trace(const ObjectRay& ray) {
    float first = 0, last = std::numeric_limits<float>::max();
    for (int a = 0; a < 3; ++a) {
        const float low = lattice_.origin[a];
        const float high = low + lattice_.cell * static_cast<float>(lattice_.cells[a]);
        const float slope = ray.direction[a] != 0 ? ray.direction[a] : 1e-12f;
        const float at_low = (low - ray.eye[a]) / slope, at_high = (high - ray.eye[a]) / slope;
        first = std::max(first, std::min(at_low, at_high));
        last = std::min(last, std::max(at_low, at_high));
    }
    for (float t = first; t <= last; t += 0.5f * lattice_.cell) {
        const Vec3 place = (ray.eye + t * ray.direction - lattice_.origin) / lattice_.cell;
        std::uint32_t point = 0;
        for (int a = 2; a >= 0; --a) {
            const int index =
                std::clamp(static_cast<int>(std::lround(place[a])), 0, lattice_.cells[a]);
            point = point * static_cast<std::uint32_t>(lattice_.cells[a] + 1) +
                    static_cast<std::uint32_t>(index);
        }
        if (ray_points_.size() == ray_begin_.back() || ray_points_.back() != point)
            ray_points_.push_back(point);
    }
    ray_view_.push_back(ray.view);
    ray_begin_.push_back(ray_points_.size());
}

std::array<Vec3, 2> OutlineVotes::likely_bounds() const {
    Vec3 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
    std::size_t point = 0;
    for (int z = 0; z <= lattice_.cells[2]; ++z) {
        for (int y = 0; y <= lattice_.cells[1]; ++y) {
            for (int x = 0; x <= lattice_.cells[0]; ++x, ++point) {
                if (shown_[point] == 0 || 4 * excluded_[point] > shown_[point]) continue;
                low = glm::min(low, Vec3(x, y, z));
                high = glm::max(high, Vec3(x, y, z));
            }
        }
    }
    if (low.x > high.x) {
        low = Vec3(0.0f);
        high = Vec3(lattice_.cells[0], lattice_.cells[1], lattice_.cells[2]);
    }
    return {lattice_.origin + lattice_.cell * (low - 1.0f),
            lattice_.origin + lattice_.cell * (high + 1.0f)};
}

void OutlineVotes::set_active(std::size_t view, bool is_active) {
    if (holds_view(active_, view) == is_active) return;
    active_[view / 64] ^= std::uint64_t{1} << (view % 64);
    for (std::size_t point = 0; point < excluded_.size(); ++point)
        if (holds_view(excluders(point), view))
            excluded_[point] = static_cast<std::uint16_t>(excluded_[point] + (is_active ? 1 : -1));
}

std::pair<int, std::size_t> OutlineVotes::fewest_excluders(std::size_t ray) const {
    std::pair<int, std::size_t> fewest{std::numeric_limits<int>::max(), 0};
    for (std::size_t i = ray_begin_[ray]; i < ray_begin_[ray + 1]; ++i) {
        const int count = excluded_[ray_points_[i]];
        if (count < fewest.first) fewest = {count, ray_points_[i]};
        if (count == 0) break;
    }
    return fewest;
}

std::size_t OutlineVotes::contradicting_rays() const {
    std::size_t count = 0;
    for (std::size_t ray = 0; ray < ray_view_.size(); ++ray)
        count += holds_view(active_, ray_view_[ray]) && fewest_excluders(ray).first > 0;
    return count;
}

std::size_t OutlineVotes::contradicting_rays(std::size_t view) const {
    std::size_t count = 0;
    for (std::size_t ray = 0; ray < ray_view_.size(); ++ray)
        count += ray_view_[ray] == view && fewest_excluders(ray).first > 0;
    return count;
}

std::size_t OutlineVotes::active_rays() const {
    return static_cast<std::size_t>(
        std::count_if(ray_view_.begin(), ray_view_.end(),
                      [&](std::size_t view) { return holds_view(active_, view); }));
}

std::size_t OutlineVotes::unsupported_rays() const {
    const auto is_support = [&](std::uint32_t point) {
        return excluded_[point] == 0 && 2 * shown_[point] >= view_count_;
    };
    std::size_t count = 0;
    for (std::size_t ray = 0; ray < ray_view_.size(); ++ray)
        count += std::none_of(
            ray_points_.begin() + static_cast<std::ptrdiff_t>(ray_begin_[ray]),
            ray_points_.begin() + static_cast<std::ptrdiff_t>(ray_begin_[ray + 1]), is_support);
    return count;
}

std::vector<double> OutlineVotes::blame() const {
    std::vector<double> blame(64 * words_, 0.0);
    for (std::size_t ray = 0; ray < ray_view_.size(); ++ray) {
        if (!holds_view(active_, ray_view_[ray])) continue;
        const auto [count, point] = fewest_excluders(ray);
        if (count == 0) continue;
        if (count == std::numeric_limits<int>::max()) {  // the ray has no points
            blame[ray_view_[ray]] += 1;
            continue;
        }
        blame[ray_view_[ray]] += static_cast<double>(count) / (count + 1);
        const std::span<const std::uint64_t> wrong = excluders(point);
        for (std::size_t word = 0; word < words_; ++word)
            for (std::uint64_t left = wrong[word] & active_[word]; left != 0; left &= left - 1)
                blame[64 * word + static_cast<std::size_t>(std::countr_zero(left))] +=
                    1.0 / (count * (count + 1.0));
    }
    return blame;
}

double share_of_rays(std::size_t count, std::size_t of) {
    return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : 0.0;
}

OutlineVotes count_votes(const std::vector<Photograph>& views, Vec3 centre, float radius) {
    std::vector<VisualHull> outlines;
    std::vector<ObjectRay> rays;
    for (std::size_t i = 0; i < views.size(); ++i) {
        outlines.emplace_back(std::vector<Photograph>{wide_outline(views[i])});
        add_object_rays(views[i], i, rays);
    }
    const float reach = 1.2f * radius;
    const Lattice all = make_lattice({centre - reach, centre + reach}, coarse_vote_cells);
    const auto bounds = OutlineVotes(outlines, {}, all).likely_bounds();
    return OutlineVotes(outlines, rays, make_lattice(bounds, fine_vote_cells));
}

/// Removes the most blamed views, one after another, until the remaining views agree or `maximum`
/// views are removed. Returns the removed views in this order. If the remaining views still
/// disagree, the result has one more entry than `maximum`.
std::vector<std::size_t> remove_blamed(OutlineVotes& votes, std::size_t maximum) {
    std::vector<std::size_t> removed;
    while (true) {
        const std::vector<double> blame = votes.blame();
        const auto worst = std::max_element(blame.begin(), blame.end());
        if (*worst < min_blame * static_cast<double>(rays_of_view)) return removed;
        if (removed.size() == maximum) {
            removed.push_back(blame.size());
            return removed;
        }
        removed.push_back(static_cast<std::size_t>(worst - blame.begin()));
        votes.set_active(removed.back(), false);
    }
}

/// Restores removed views that agree with the remaining ones. They were removed because of faults
/// of other views.
void readmit(OutlineVotes& votes, std::vector<std::size_t>& removed) {
    for (std::size_t i = removed.size(); i-- > 0;) {
        const std::size_t view = removed[i];
        const std::size_t before = votes.contradicting_rays();
        const std::size_t own = votes.contradicting_rays(view);
        votes.set_active(view, true);
        const std::size_t harm = votes.contradicting_rays() - before - own;
        const double blame = static_cast<double>(own) + 0.5 * static_cast<double>(harm);
        if (blame < min_blame * static_cast<double>(rays_of_view))
            removed.erase(removed.begin() + static_cast<std::ptrdiff_t>(i));
        else
            votes.set_active(view, false);
    }
}

}  // namespace

Contradictions find_contradictions(const std::vector<Photograph>& views, Vec3 centre,
                                   float radius) {
    OutlineVotes votes = count_votes(views, centre, radius);
    Contradictions found;
    found.share = found.share_of_rest =
        share_of_rays(votes.contradicting_rays(), votes.active_rays());
    // With three or four inconsistent views none can be identified as wrong.
    const std::size_t maximum = views.size() < 5 ? 0 : std::max<std::size_t>(1, views.size() / 5);
    found.views = remove_blamed(votes, maximum);
    if (found.views.size() > maximum) {
        found.views.clear();
        found.unsolved = true;
        return found;
    }
    readmit(votes, found.views);
    const double left = share_of_rays(votes.contradicting_rays(), votes.active_rays());
    if (left <= unsolved_part * found.share) {
        found.share_of_rest = left;
    } else {
        found.views.clear();
        found.unsolved = found.share > min_unsolved;
    }
    return found;
}

double unsupported_share(const std::vector<Photograph>& views, Vec3 centre, float radius) {
    const OutlineVotes votes = count_votes(views, centre, radius);
    return share_of_rays(votes.unsupported_rays(), votes.active_rays());
}

std::vector<Photograph> small_masks(const std::vector<Photograph>& views) {
    std::vector<Photograph> masks(views.size());
    parallel_for(
        "small_masks", static_cast<std::int64_t>(views.size()),
        [&](std::int64_t i) {
            const Photograph& view = views[static_cast<std::size_t>(i)];
            const Image& image = view.image;
            const int shrink =
                std::max(1, (std::max(image.width, image.height) + longest_small_side / 2) /
                                longest_small_side);
            Image mask(std::max(1, image.width / shrink), std::max(1, image.height / shrink), 2);
            std::vector<float> counts(mask.pixels.size() / 2, 0.0f);
            for (int y = 0; y < image.height; ++y) {
                for (int x = 0; x < image.width; ++x) {
                    const float coverage = image.at(x, y, image.channels - 1);
                    const int to_x = x * mask.width / image.width;
                    const int to_y = y * mask.height / image.height;
                    mask.at(to_x, to_y, 0) += coverage;
                    mask.at(to_x, to_y, 1) = std::max(mask.at(to_x, to_y, 1), coverage);
                    ++counts[static_cast<std::size_t>(to_y) * mask.width + to_x];
                }
            }
            for (std::size_t p = 0; p < counts.size(); ++p)
                mask.pixels[2 * p] /= counts[p];
            masks[static_cast<std::size_t>(i)] = {view.name, view.camera, std::move(mask)};
        },
        1);
    return masks;
}

}  // namespace item3d
