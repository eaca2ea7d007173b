#include "item3d/lighting/image_based_light.h"

#include "item3d/lighting/environment.h"

#include <cmath>

namespace item3d {

const std::array<CubeFaceAxes, 6> gltf_face_axes = {{
    {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
    {{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
    {{0, 1, 0}, {-1, 0, 0}, {0, 0, -1}},
    {{0, -1, 0}, {-1, 0, 0}, {0, 0, 1}},
    {{0, 0, 1}, {-1, 0, 0}, {0, 1, 0}},
    {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}},
}};

std::array<float, 9> spherical_harmonics(Vec3 d) {
    return {0.282095f,
            0.488603f * d.y,
            0.488603f * d.z,
            0.488603f * d.x,
            1.092548f * d.x * d.y,
            1.092548f * d.y * d.z,
            0.315392f * (3 * d.z * d.z - 1),
            1.092548f * d.x * d.z,
            0.546274f * (d.x * d.x - d.y * d.y)};
}

std::array<Vec3, 9> irradiance_harmonics(const Image& light) {
    std::array<glm::dvec3, 9> sums{};
    for (int y = 0; y < light.height; ++y) {
        const double solid_angle =
            texel_solid_angle(y, light.height) * 2.0 * light.height / light.width;
        for (int x = 0; x < light.width; ++x) {
            const auto basis = spherical_harmonics(equirectangular_direction(
                (static_cast<float>(x) + 0.5f) / static_cast<float>(light.width),
                (static_cast<float>(y) + 0.5f) / static_cast<float>(light.height)));
            const glm::dvec3 radiance(light.at(x, y, 0), light.at(x, y, 1), light.at(x, y, 2));
            for (std::size_t i = 0; i < 9; ++i)
                sums[i] += solid_angle * basis[i] * radiance;
        }
    }
    // Coefficients of the cosine lobe, by band (the paper's equation 8).
    constexpr std::array<double, 3> lobe = {M_PI, 2 * M_PI / 3, M_PI / 4};
    std::array<Vec3, 9> result;
    for (std::size_t i = 0; i < 9; ++i)
        result[i] = Vec3(lobe[i == 0 ? 0 : (i < 4 ? 1 : 2)] * sums[i]);
    return result;
}

}  // namespace item3d
