#include "item3d/lighting/presets/studio.h"

#include "item3d/core/parallel.h"
#include "item3d/lighting/environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace item3d {

namespace {

// Lengths are in metres. The viewer is at the origin.
constexpr float half_width = 4.5f;
constexpr float floor_height = -1.7f;
constexpr float ceiling_height = 3.3f;

/// A rectangular light that faces the origin.
struct SoftBox {
    Vec3 centre;
    float width;
    float height;
    Vec3 radiance;
    Vec3 right{0};
    Vec3 up{0};
    Vec3 facing{0};
    std::array<Vec3, 4> vertices;
    float reach = 0;  ///< angle around `centre` that contains the box

    SoftBox(Vec3 at, float box_width, float box_height, Vec3 light)
        : centre(at), width(box_width), height(box_height), radiance(light) {
        facing = -glm::normalize(at);
        const Vec3 above = std::abs(facing.y) > 0.99f ? Vec3(0, 0, 1) : Vec3(0, 1, 0);
        right = glm::normalize(glm::cross(above, facing));
        up = glm::cross(facing, right);
        const Vec3 x = 0.5f * width * right;
        const Vec3 y = 0.5f * height * up;
        vertices = {centre - x - y, centre + x - y, centre + x + y, centre - x + y};
        for (const Vec3& vertex : vertices)
            reach = std::max(reach, std::acos(glm::dot(glm::normalize(vertex), -facing)));
    }
};

const std::vector<SoftBox>& soft_boxes() {
    // The gaps between the boxes are large and dark, because metal needs bright and dark
    // reflections.
    static const std::vector<SoftBox> boxes = {
        {Vec3(2.7f, 1.7f, 2.5f), 2.0f, 1.7f, Vec3(20.0f, 18.8f, 17.2f)},    // key
        {Vec3(-3.5f, 0.6f, 1.5f), 1.3f, 2.6f, Vec3(5.0f, 5.6f, 6.4f)},      // fill
        {Vec3(-1.5f, 1.1f, -3.6f), 0.5f, 2.8f, Vec3(15.0f, 15.0f, 16.0f)},  // strip light behind
        {Vec3(3.3f, 0.7f, -2.3f), 0.45f, 2.4f, Vec3(9.0f, 9.0f, 9.4f)},  // strip light at the side
        {Vec3(0.0f, 2.9f, 0.0f), 1.8f, 1.8f, Vec3(6.5f, 6.5f, 6.5f)},    // top
    };
    return boxes;
}

/// Returns the irradiance from a polygon of radiance 1 on the side of `point` given by `normal`.
float polygon_irradiance(Vec3 point, Vec3 normal, const std::array<Vec3, 4>& polygon) {
    std::array<Vec3, 8> clipped;
    int count = 0;
    for (int i = 0; i < 4; ++i) {
        const Vec3 a = polygon[i] - point;
        const Vec3 b = polygon[(i + 1) % 4] - point;
        const float height_a = glm::dot(a, normal);
        const float height_b = glm::dot(b, normal);
        if (height_a > 0) clipped[count++] = glm::normalize(a);
        if ((height_a > 0) != (height_b > 0)) {
            clipped[count++] = glm::normalize(glm::mix(a, b, height_a / (height_a - height_b)));
        }
    }
    float sum = 0;
    for (int i = 0; i < count; ++i) {
        const Vec3 a = clipped[i];
        const Vec3 b = clipped[(i + 1) % count];
        const Vec3 cross = glm::cross(a, b);
        const float length = glm::length(cross);
        if (length < 1e-7f) continue;
        sum += std::atan2(length, glm::dot(a, b)) * glm::dot(normal, cross) / length;
    }
    return std::abs(0.5f * sum);
}

Vec3 direct_irradiance(Vec3 point, Vec3 normal) {
    Vec3 sum(0);
    for (const SoftBox& box : soft_boxes()) {
        if (glm::dot(point - box.centre, box.facing) <= 0) continue;  // behind the box
        sum += box.radiance * polygon_irradiance(point, normal, box.vertices);
    }
    return sum;
}

struct RoomPoint {
    Vec3 position;
    Vec3 normal;
    Vec3 albedo;
};

RoomPoint room_point(Vec3 direction) {
    const Vec3 low(-half_width, floor_height, -half_width);
    const Vec3 high(half_width, ceiling_height, half_width);
    float nearest = std::numeric_limits<float>::max();
    int axis = 0;
    for (int i = 0; i < 3; ++i) {
        if (direction[i] == 0) continue;
        const float distance = (direction[i] > 0 ? high[i] : low[i]) / direction[i];
        if (distance < nearest) {
            nearest = distance;
            axis = i;
        }
    }
    RoomPoint point;
    point.position = nearest * direction;
    point.normal = Vec3(0);
    point.normal[axis] = direction[axis] > 0 ? -1.0f : 1.0f;
    point.albedo = Vec3(0.24f);
    if (axis == 1) point.albedo = direction.y > 0 ? Vec3(0.14f) : Vec3(0.36f, 0.35f, 0.34f);
    return point;
}

/// Returns the walls' interreflection after the first bounce, as uniform irradiance.
Vec3 indirect_irradiance() {
    Vec3 first_bounce(0);
    double weights = 0;
    float albedo = 0;
    constexpr int rows = 24;
    for (int y = 0; y < rows; ++y) {
        const float weight = static_cast<float>(texel_solid_angle(y, rows));
        for (int x = 0; x < 2 * rows; ++x) {
            const RoomPoint point =
                room_point(equirectangular_direction((x + 0.5f) / (2 * rows), (y + 0.5f) / rows));
            first_bounce += weight * point.albedo * direct_irradiance(point.position, point.normal);
            albedo += weight * point.albedo.y;
            weights += weight;
        }
    }
    const float mean_albedo = albedo / static_cast<float>(weights);
    return first_bounce / static_cast<float>(weights) / (1 - mean_albedo);
}

/// Returns the relative radiance of a soft box. It is highest at the lamp and falls off towards the
/// frame.
float box_profile(float x, float y) {
    return 1.12f - 0.36f * (x * x + y * y);
}

/// Returns the radiance of the nearest box in this direction, if any.
std::optional<Vec3> box_radiance(Vec3 direction) {
    float nearest = std::numeric_limits<float>::max();
    Vec3 seen(0);
    for (const SoftBox& box : soft_boxes()) {
        const float distance = glm::dot(box.centre, box.facing) / glm::dot(direction, box.facing);
        if (!(distance > 0) || distance >= nearest) continue;
        const Vec3 offset = distance * direction - box.centre;
        const float x = 2 * glm::dot(offset, box.right) / box.width;
        const float y = 2 * glm::dot(offset, box.up) / box.height;
        if (std::abs(x) > 1 || std::abs(y) > 1) continue;
        nearest = distance;
        seen = box.radiance * box_profile(x, y);
    }
    if (nearest < std::numeric_limits<float>::max()) return seen;
    return std::nullopt;
}

/// True if a box may be visible within an angle around this direction.
bool near_a_box(Vec3 direction, float angle) {
    for (const SoftBox& box : soft_boxes())
        if (glm::dot(direction, -box.facing) > std::cos(box.reach + angle)) return true;
    return false;
}

Vec3 room_radiance(Vec3 direction, Vec3 indirect) {
    const RoomPoint point = room_point(direction);
    return point.albedo * (direct_irradiance(point.position, point.normal) + indirect) / pi;
}

}  // namespace

Image make_studio(int height) {
    Image image(2 * height, height, 3);
    const Vec3 indirect = indirect_irradiance();
    constexpr int points = 3;
    const float texel = pi / static_cast<float>(height);
    parallel_for(
        "studio", height,
        [&](std::int64_t y) {
            for (int x = 0; x < image.width; ++x) {
                // Supersamples the boxes, which have sharp edges, but not the background, which
                // varies slowly and costs more.
                Vec3 sum(0);
                int behind = 0;
                const auto direction = [&](float column, float row) {
                    return equirectangular_direction((x + column) / image.width,
                                                     (y + row) / height);
                };
                const Vec3 middle = direction(0.5f, 0.5f);
                if (near_a_box(middle, texel)) {
                    for (int i = 0; i < points * points; ++i) {
                        const auto box = box_radiance(
                            direction((i % points + 0.5f) / points, (i / points + 0.5f) / points));
                        if (box)
                            sum += *box;
                        else
                            ++behind;
                    }
                } else {
                    behind = points * points;
                }
                if (behind > 0) sum += static_cast<float>(behind) * room_radiance(middle, indirect);
                for (int c = 0; c < 3; ++c) {
                    image.at(x, static_cast<int>(y), c) = sum[c] / (points * points);
                }
            }
        },
        4);
    return image;
}

}  // namespace item3d
