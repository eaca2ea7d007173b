#include "apps/make_demo/mug.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace item3d::demo {

namespace {

constexpr int segments = 96;          ///< around the axis
constexpr int handle_rings = 56;      ///< along the handle
constexpr int handle_segments = 24;   ///< around the handle
constexpr float uv_per_metre = 3.6f;  ///< one scale for all islands: a texel is 0.27 mm at 1024
constexpr float margin = 0.012f;      ///< between islands, 12 texels at 1024

/// Replaces the corners of a polyline by arcs of at most `radius`. For smooth shading, long edges
/// get a point every `step` as well.
std::vector<Vec2> rounded(const std::vector<Vec2>& corners, const std::vector<float>& radii,
                          float step) {
    std::vector<Vec2> points = {corners.front()};
    const auto line_to = [&](Vec2 end) {
        const Vec2 start = points.back();
        const int count = std::max(1, static_cast<int>(glm::distance(start, end) / step));
        for (int i = 1; i <= count; ++i) {
            points.push_back(glm::mix(start, end, static_cast<float>(i) / count));
        }
    };
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        const Vec2 before = glm::normalize(corners[i - 1] - corners[i]);
        const Vec2 after = glm::normalize(corners[i + 1] - corners[i]);
        line_to(corners[i] + radii[i] * before);
        constexpr int arc = 7;
        for (int k = 1; k <= arc; ++k) {
            const float t = static_cast<float>(k) / arc;
            points.push_back((1 - t) * (1 - t) * (corners[i] + radii[i] * before) +
                             2 * t * (1 - t) * corners[i] +
                             t * t * (corners[i] + radii[i] * after));
        }
    }
    line_to(corners.back());
    return points;
}

std::vector<float> arc_length(const std::vector<Vec2>& points) {
    std::vector<float> length = {0};
    for (std::size_t i = 1; i < points.size(); ++i) {
        length.push_back(length.back() + glm::distance(points[i - 1], points[i]));
    }
    return length;
}

Vec3 lathed(Vec2 profile, float angle) {
    return Vec3(profile.x * std::sin(angle), profile.y, profile.x * std::cos(angle));
}

/// Returns a point of the handle's centre line in the plane z = 0: a C that starts and ends inside
/// the mug's wall.
Vec2 handle_spine(float t) {
    static const std::array<Vec2, 6> control = {Vec2(0.0385f, 0.0770f), Vec2(0.0560f, 0.0810f),
                                                Vec2(0.0760f, 0.0740f), Vec2(0.0740f, 0.0430f),
                                                Vec2(0.0560f, 0.0230f), Vec2(0.0375f, 0.0205f)};
    std::array<Vec2, 6> points = control;  // de Casteljau
    for (int level = 5; level > 0; --level) {
        for (int i = 0; i < level; ++i)
            points[i] = glm::mix(points[i], points[i + 1], t);
    }
    return points[0];
}

}  // namespace

Mug::Mug() {
    primitive_.name = "mug";
    // The profile is closed. It goes from the middle of the underside outwards, up, over the rim
    // and inwards.
    const auto underside = rounded(
        {{0, 0.0045f}, {0.0235f, 0.0040f}, {0.0262f, 0.0f}, {0.0300f, 0.0f}, {0.0322f, 0.0030f}},
        {0, 0.0014f, 0.0010f, 0.0012f, 0}, 0.004f);
    const auto outside =
        rounded({{0.0322f, 0.0030f}, {0.0402f, 0.0110f}, {0.0415f, 0.0950f}, {0.03965f, 0.0952f}},
                {0, 0.0075f, 0.0014f, 0}, 0.004f);
    const auto inside =
        rounded({{0.03965f, 0.0952f}, {0.0378f, 0.0950f}, {0.0366f, 0.0075f}, {0.0260f, 0.0072f}},
                {0, 0.0014f, 0.0085f, 0}, 0.004f);
    const auto bottom = rounded({{0.0260f, 0.0072f}, {0, 0.0070f}}, {0, 0}, 0.004f);

    // The UV square has three rows: the inner wall, the outer wall, and a row of the discs and the
    // handle.
    float top = margin;
    for (const auto* strip : {&outside, &inside}) {
        Lathe lathe;
        lathe.profile = *strip;
        lathe.length = arc_length(*strip);
        lathe.corner = Vec2(margin, top);
        lathe.width = uv_per_metre * 2 * pi * (strip == &outside ? 0.0408f : 0.0368f);
        lathe.inside = strip == &inside ? 1.0f : 0.0f;
        top += uv_per_metre * lathe.length.back() + margin;
        lathes_.push_back(lathe);
    }
    float left = margin;
    for (const auto* cap : {&underside, &bottom}) {
        Lathe lathe;
        lathe.profile = *cap;
        lathe.length = arc_length(*cap);
        if (cap == &bottom) {
            // Arc length is measured from the axis on both discs.
            std::reverse(lathe.profile.begin(), lathe.profile.end());
            lathe.length = arc_length(lathe.profile);
        }
        const float radius = uv_per_metre * lathe.length.back();
        lathe.corner = Vec2(left + radius, top + radius);
        lathe.disc = true;
        lathe.inside = cap == &bottom ? 1.0f : 0.0f;
        left += 2 * radius + margin;
        lathes_.push_back(lathe);
    }
    float handle_length = 0;
    for (int i = 0; i < 200; ++i) {
        handle_length += glm::distance(handle_spine(i / 200.0f), handle_spine((i + 1) / 200.0f));
    }
    handle_corner_ = Vec2(left, top);
    handle_size_ = uv_per_metre * Vec2(handle_length, 0.0385f);

    for (const Lathe& lathe : lathes_)
        add_lathe(lathe);
    add_handle();
    compute_smooth_normals(primitive_);
}

// No island is mirrored. Seen from outside, u increases to the right if v increases downwards. The
// outer wall is upright in the image, and so is the inner wall seen from inside the mug.
Vec2 Mug::lathe_uv(const Lathe& lathe, float distance, float turn) {
    const float reach = uv_per_metre * distance;
    if (lathe.disc) {
        const float angle = 2 * pi * turn;
        const float side = lathe.inside > 0 ? 1.0f : -1.0f;
        return lathe.corner + reach * Vec2(std::sin(angle), side * std::cos(angle));
    }
    const float extent = uv_per_metre * lathe.length.back();
    return lathe.corner + (lathe.inside > 0 ? Vec2((1 - turn) * lathe.width, reach)
                                            : Vec2(turn * lathe.width, extent - reach));
}

Vec2 Mug::lathe_place(const Lathe& lathe, Vec2 uv) {
    const Vec2 from = uv - lathe.corner;
    if (lathe.disc) {
        const float side = lathe.inside > 0 ? 1.0f : -1.0f;
        return Vec2(glm::length(from) / uv_per_metre, std::atan2(from.x, side * from.y) / (2 * pi));
    }
    if (lathe.inside > 0) return Vec2(from.y / uv_per_metre, 1 - from.x / lathe.width);
    return Vec2(lathe.length.back() - from.y / uv_per_metre, from.x / lathe.width);
}

void Mug::add_lathe(const Lathe& lathe) {
    const auto first = static_cast<std::uint32_t>(primitive_.positions.size());
    const int rows = static_cast<int>(lathe.profile.size());
    // On discs the first row is the axis. It has one vertex per segment, and all of them coincide.
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column <= segments; ++column) {
            const float turn = static_cast<float>(column) / segments;
            // The last column closes the circle exactly, so that equal positions share a normal.
            const float angle = column == segments ? 0.0f : 2 * pi * turn;
            primitive_.positions.push_back(lathed(lathe.profile[row], angle));
            primitive_.uvs.push_back(lathe_uv(lathe, lathe.length[row], turn));
        }
    }
    // Profiles have the outside on their right, except the inner bottom, which is reversed.
    const bool flip = lathe.disc && lathe.inside > 0;
    for (int row = 0; row + 1 < rows; ++row) {
        for (int column = 0; column < segments; ++column) {
            const std::uint32_t a = first + row * (segments + 1) + column;
            const std::uint32_t b = a + 1;
            const std::uint32_t c = a + segments + 1;
            const std::uint32_t d = c + 1;
            const auto add = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
                const auto& p = primitive_.positions;
                if (p[i] == p[j] || p[j] == p[k] || p[k] == p[i]) return;
                if (flip) std::swap(j, k);
                primitive_.indices.insert(primitive_.indices.end(), {i, j, k});
            };
            add(a, b, d);
            add(a, d, c);
        }
    }
}

Vec3 Mug::handle_point(float along, float around) const {
    const float t = std::clamp(along, 0.0f, 1.0f);
    const Vec2 spine = handle_spine(t);
    const float low = std::max(0.0f, t - 1e-3f);
    const Vec2 tangent =
        glm::normalize(handle_spine(std::min(1.0f, t + 1e-3f)) - handle_spine(low));
    const Vec2 outwards(-tangent.y, tangent.x);
    // The handle is flat like a strap, and wider near the wall.
    const float from_end = std::min(t, 1 - t);
    const float flare = 1 + 0.55f * std::exp(-from_end * from_end / 0.0045f);
    const float angle = 2 * pi * around;
    const float wide = 0.0066f * flare * std::cos(angle);
    const float thick = 0.0046f * flare * std::sin(angle);
    const Vec2 in_plane = spine + thick * outwards;
    return Vec3(in_plane.x, in_plane.y, wide);
}

void Mug::add_handle() {
    const auto first = static_cast<std::uint32_t>(primitive_.positions.size());
    for (int ring = 0; ring <= handle_rings; ++ring) {
        const float along = static_cast<float>(ring) / handle_rings;
        for (int column = 0; column <= handle_segments; ++column) {
            const float around = static_cast<float>(column) / handle_segments;
            primitive_.positions.push_back(
                handle_point(along, column == handle_segments ? 0.0f : around));
            primitive_.uvs.push_back(handle_corner_ + handle_size_ * Vec2(along, around));
        }
    }
    for (int ring = 0; ring < handle_rings; ++ring) {
        for (int column = 0; column < handle_segments; ++column) {
            const std::uint32_t a = first + ring * (handle_segments + 1) + column;
            const std::uint32_t b = a + 1;
            const std::uint32_t c = a + handle_segments + 1;
            const std::uint32_t d = c + 1;
            primitive_.indices.insert(primitive_.indices.end(), {a, b, d, a, d, c});
        }
    }
}

Vec2 Mug::profile_at(const Lathe& lathe, float distance) {
    const auto& length = lathe.length;
    distance = std::clamp(distance, 0.0f, length.back());
    const auto next = std::upper_bound(length.begin() + 1, length.end() - 1, distance);
    const auto i = static_cast<std::size_t>(next - length.begin());
    const float t = (distance - length[i - 1]) / (length[i] - length[i - 1]);
    return glm::mix(lathe.profile[i - 1], lathe.profile[i], t);
}

SkinPoint Mug::skin(Vec2 uv) const {
    const auto outside_box = [&](Vec2 corner, Vec2 size) {
        return glm::length(glm::max(glm::max(corner - uv, uv - corner - size), Vec2(0)));
    };
    SkinPoint point;
    point.position = handle_point((uv.x - handle_corner_.x) / handle_size_.x,
                                  (uv.y - handle_corner_.y) / handle_size_.y);
    point.handle = 1;
    point.underside = -1;
    float nearest = outside_box(handle_corner_, handle_size_);
    for (const Lathe& lathe : lathes_) {
        const float extent = uv_per_metre * lathe.length.back();
        const float gap = lathe.disc ? std::max(0.0f, glm::distance(uv, lathe.corner) - extent)
                                     : outside_box(lathe.corner, Vec2(lathe.width, extent));
        if (gap >= nearest) continue;
        nearest = gap;
        const Vec2 place = lathe_place(lathe, uv);
        const float distance = place.x;
        const float angle = 2 * pi * place.y;
        point.position = lathed(profile_at(lathe, distance), angle);
        point.inside = lathe.inside;
        point.underside = lathe.disc && lathe.inside == 0 ? distance : -1;
        point.handle = 0;
    }
    return point;
}

}  // namespace item3d::demo
