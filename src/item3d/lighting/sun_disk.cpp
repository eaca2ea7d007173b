#include "item3d/lighting/sun_disk.h"

#include "item3d/lighting/environment.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace item3d {

namespace {

/// Returns the part of texel (x, y) that the disk covers, estimated from 8 x 8 points.
double coverage_of(int x, int y, const Image& light, const SunDisk& disk, float cosine_radius,
                   float cosine_far) {
    const int width = light.width;
    const int height = light.height;
    const Vec3 middle = equirectangular_direction((x + 0.5f) / width, (y + 0.5f) / height);
    if (glm::dot(middle, disk.direction) < cosine_far) return 0;
    constexpr int points = 8;
    int inside = 0;
    for (int i = 0; i < points * points; ++i) {
        const Vec3 direction =
            equirectangular_direction((x + (i % points + 0.5f) / points) / width,
                                      (y + (i / points + 0.5f) / points) / height);
        inside += glm::dot(direction, disk.direction) >= cosine_radius &&
                  (!disk.above_horizon || direction.y > 0);
    }
    return static_cast<double>(inside) / (points * points);
}

}  // namespace

void add_sun_disk(Image& light, const SunDisk& disk) {
    const int width = light.width;
    const int height = light.height;
    // Images that are not 2:1 have wider or narrower texels.
    const double stretch = 2.0 * height / width;
    const float texel_size = 2 * pi / static_cast<float>(std::min(height, width / 2));
    const float cosine_radius = std::cos(disk.radius);
    const float cosine_far = std::cos(std::min(pi, disk.radius + texel_size));
    std::vector<double> coverage(static_cast<std::size_t>(width) * height);
    double solid_angle = 0;
    for (int y = 0; y < height; ++y) {
        const double texel = stretch * texel_solid_angle(y, height);
        for (int x = 0; x < width; ++x) {
            const double covered = coverage_of(x, y, light, disk, cosine_radius, cosine_far);
            coverage[static_cast<std::size_t>(y) * width + x] = covered;
            solid_angle += covered * texel;
        }
    }
    if (solid_angle == 0) {
        // A disk that is smaller than the spacing of the sample points is put into one texel.
        const Vec2 uv = equirectangular_uv(disk.direction);
        const int x = std::min(static_cast<int>(uv.x * width), width - 1);
        const int y = std::min(static_cast<int>(uv.y * height), height - 1);
        coverage[static_cast<std::size_t>(y) * width + x] = 1;
        solid_angle = stretch * texel_solid_angle(y, height);
    }
    for (std::size_t i = 0; i < coverage.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            light.pixels[3 * i + c] +=
                static_cast<float>(coverage[i] * disk.irradiance[c] / solid_angle);
        }
    }
}

}  // namespace item3d
