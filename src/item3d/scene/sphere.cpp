#include "item3d/scene/sphere.h"

#include <cmath>
#include <cstdint>

namespace item3d {

Model make_unit_sphere(int latitudes, int longitudes) {
    Primitive sphere;
    for (int i = 0; i <= latitudes; ++i) {
        for (int j = 0; j <= longitudes; ++j) {
            const float u = static_cast<float>(j) / static_cast<float>(longitudes);
            const float v = static_cast<float>(i) / static_cast<float>(latitudes);
            const float theta = pi * v, phi = 2 * pi * u;
            const Vec3 p(std::sin(theta) * std::sin(phi), std::cos(theta),
                         std::sin(theta) * std::cos(phi));
            sphere.positions.push_back(p);
            sphere.normals.push_back(p);
            sphere.uvs.push_back(Vec2(u, v));
        }
    }
    for (int i = 0; i < latitudes; ++i) {
        for (int j = 0; j < longitudes; ++j) {
            const auto a = static_cast<std::uint32_t>(i * (longitudes + 1) + j);
            const auto b = a + static_cast<std::uint32_t>(longitudes + 1);
            for (const std::uint32_t index : {a, b, b + 1, a, b + 1, a + 1})
                sphere.indices.push_back(index);
        }
    }
    Model model;
    model.materials.emplace_back();
    model.primitives.push_back(std::move(sphere));
    return model;
}

}  // namespace item3d
