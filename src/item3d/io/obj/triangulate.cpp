#include "item3d/io/obj/triangulate.h"

#include <cmath>

namespace item3d {
namespace {

using DVec2 = glm::dvec2;
using DVec3 = glm::dvec3;

std::vector<DVec2> project(std::span<const Vec3> corners) {
    const DVec3 origin(corners[0]);
    DVec3 normal(0.0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const DVec3 a = DVec3(corners[i]) - origin;
        const DVec3 b = DVec3(corners[(i + 1) % corners.size()]) - origin;
        normal += glm::cross(a, b);
    }
    // Dropping the largest component keeps the orientation if the axes are taken cyclically.
    const DVec3 size = glm::abs(normal);
    const int drop = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const int u = (drop + 1) % 3;
    const int v = (drop + 2) % 3;
    const double sign = normal[drop] < 0 ? -1.0 : 1.0;
    std::vector<DVec2> points;
    points.reserve(corners.size());
    for (const Vec3& corner : corners) {
        const DVec3 p = DVec3(corner) - origin;
        points.emplace_back(p[u], sign * p[v]);
    }
    return points;
}

double turn(const DVec2& a, const DVec2& b, const DVec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool is_convex(std::span<const DVec2> points) {
    // A polygon is convex if every corner turns left and the outline makes one full turn, that is,
    // if the sign of its steps in x changes twice.
    int changes = 0;
    double last = 0.0;
    double first = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const DVec2& a = points[i];
        const DVec2& b = points[(i + 1) % points.size()];
        if (turn(a, b, points[(i + 2) % points.size()]) < 0.0) return false;
        const double step = b.x - a.x;
        if (step == 0.0) continue;
        if (first == 0.0) first = step;
        if (last != 0.0 && (step > 0.0) != (last > 0.0)) ++changes;
        last = step;
    }
    if ((first > 0.0) != (last > 0.0)) ++changes;
    return changes <= 2;
}

class EarClipper {
  public:
    explicit EarClipper(std::span<const DVec2> points) : points_(points) {
        const auto count = static_cast<std::uint32_t>(points.size());
        for (std::uint32_t i = 0; i < count; ++i) {
            next_.push_back((i + 1) % count);
            previous_.push_back((i + count - 1) % count);
        }
        for (std::uint32_t i = 0; i < count; ++i)
            ear_.push_back(is_ear(i));
    }

    std::vector<std::uint32_t> run() {
        std::vector<std::uint32_t> triangles;
        std::uint32_t at = 0;
        for (std::size_t left = points_.size(); left > 3; --left) {
            // A polygon that crosses itself may have no ear; any corner is then cut.
            for (std::size_t tries = 0; tries < left && !ear_[at]; ++tries)
                at = next_[at];
            const std::uint32_t before = previous_[at];
            const std::uint32_t after = next_[at];
            triangles.insert(triangles.end(), {before, at, after});
            next_[before] = after;
            previous_[after] = before;
            ear_[before] = is_ear(before);
            ear_[after] = is_ear(after);
            at = next_[after];
        }
        triangles.insert(triangles.end(), {previous_[at], at, next_[at]});
        return triangles;
    }

  private:
    bool is_ear(std::uint32_t i) const {
        const DVec2& a = points_[previous_[i]];
        const DVec2& b = points_[i];
        const DVec2& c = points_[next_[i]];
        if (turn(a, b, c) <= 0.0) return false;
        for (std::uint32_t k = next_[next_[i]]; k != previous_[i]; k = next_[k]) {
            const DVec2& p = points_[k];
            if (p == a || p == b || p == c) continue;
            if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
        }
        return true;
    }

    std::span<const DVec2> points_;
    std::vector<std::uint32_t> next_;
    std::vector<std::uint32_t> previous_;
    std::vector<bool> ear_;
};

}  // namespace

std::vector<std::uint32_t> triangulate_polygon(std::span<const Vec3> corners) {
    constexpr std::size_t max_corners_to_clip = 4096;
    if (corners.size() > 3 && corners.size() <= max_corners_to_clip) {
        const std::vector<DVec2> points = project(corners);
        if (!is_convex(points)) return EarClipper(points).run();
    }
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t i = 2; i < corners.size(); ++i)
        triangles.insert(triangles.end(), {0, i - 1, i});
    return triangles;
}

}  // namespace item3d
