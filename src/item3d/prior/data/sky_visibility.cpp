#include "item3d/prior/data/sky_visibility.h"

#include "item3d/lighting/environment.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

/// Edge of the cells whose points share rays. It is about a pixel of a training image, for shapes
/// of radius 1.
constexpr float cell_edge = .035f;
/// Distance of the rays' origins above the surface.
constexpr float above = .02f;
/// Cosine of the angular radius of a sky part; its neighbours are about 35 degrees away.
constexpr float widest = .82f;

}  // namespace

const std::array<Vec3, sky_parts>& sky_directions() {
    static const std::array<Vec3, sky_parts> directions = [] {
        std::array<Vec3, sky_parts> all;
        for (std::size_t i = 0; i < sky_parts; ++i) {
            const float y = 1 - 2 * (static_cast<float>(i) + .5f) / sky_parts;
            const float angle = 2.3999632f * static_cast<float>(i);
            const float r = std::sqrt(1 - y * y);
            all[i] = Vec3(r * std::cos(angle), y, r * std::sin(angle));
        }
        return all;
    }();
    return directions;
}

SkyLight sky_light(const Image& map) {
    SkyLight light{};
    const auto& directions = sky_directions();
    for (int y = 0; y < map.height; ++y) {
        const auto solid_angle = static_cast<float>(texel_solid_angle(y, map.height));
        for (int x = 0; x < map.width; ++x) {
            const Vec3 d = equirectangular_direction((static_cast<float>(x) + .5f) / map.width,
                                                     (static_cast<float>(y) + .5f) / map.height);
            const float luminance =
                .2126f * map.at(x, y, 0) + .7152f * map.at(x, y, 1) + .0722f * map.at(x, y, 2);
            std::array<float, sky_parts> weight;
            float sum = 0;
            for (std::size_t i = 0; i < sky_parts; ++i)
                sum += weight[i] = std::max(glm::dot(d, directions[i]) - widest, 0.0f);
            if (sum <= 0) continue;
            for (std::size_t i = 0; i < sky_parts; ++i)
                light[i] += weight[i] / sum * luminance * solid_angle;
        }
    }
    return light;
}

float arriving_share(std::uint32_t visible, const Vec3& n, const SkyLight& light) {
    const auto& directions = sky_directions();
    float arrives = 0, comes = 0;
    for (std::size_t i = 0; i < sky_parts; ++i) {
        const float part = light[i] * std::max(glm::dot(n, directions[i]), 0.0f);
        comes += part;
        arrives += (visible >> i & 1u) != 0 ? part : 0.0f;
    }
    return comes > 0 ? arrives / comes : 1.0f;
}

std::uint32_t SkyVisibility::at(const Vec3& p, const Vec3& n) {
    const Vec3 origin = p + above * n;
    const glm::ivec3 cell(glm::floor(origin / cell_edge));
    const auto part = [](int coordinate) {
        return static_cast<std::uint64_t>(coordinate + 1024) & 2047u;
    };
    const std::uint64_t key = part(cell.x) << 22 | part(cell.y) << 11 | part(cell.z);
    const auto [found, fresh] = known_.try_emplace(key, 0u);
    if (fresh) {
        const auto& directions = sky_directions();
        for (std::size_t i = 0; i < sky_parts; ++i)
            if (!scene_.blocked(origin, directions[i])) found->second |= 1u << i;
    }
    return found->second;
}

}  // namespace item3d
