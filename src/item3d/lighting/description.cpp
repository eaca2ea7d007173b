#include "item3d/lighting/description.h"

#include "item3d/core/error.h"
#include "item3d/lighting/environment.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace item3d {

namespace {

using Double3 = glm::dvec3;

Double3 radiance_at(const Image& light, int x, int y) {
    return {light.at(x, y, 0), light.at(x, y, 1), light.at(x, y, 2)};
}

Vec3 direction_at(const Image& light, int x, int y) {
    return equirectangular_direction((static_cast<float>(x) + 0.5f) / light.width,
                                     (static_cast<float>(y) + 0.5f) / light.height);
}

/// Returns the solid angle of a row's texel, also for images that are not 2:1.
double solid_angle_of_row(const Image& light, int y) {
    return texel_solid_angle(y, light.height) * 2.0 * light.height / light.width;
}

/// Averages blocks of texels, weighted by solid angle, down to at most 64 rows.
Image shrink(const Image& light) {
    const int block = std::max(1, light.height / 64);
    if (block == 1) return light;
    Image small((light.width + block - 1) / block, (light.height + block - 1) / block, 3);
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
            double weights = 0;
            double sum[3] = {0, 0, 0};
            for (int j = y * block; j < std::min((y + 1) * block, light.height); ++j) {
                const double weight = texel_solid_angle(j, light.height);
                for (int i = x * block; i < std::min((x + 1) * block, light.width); ++i) {
                    weights += weight;
                    for (int c = 0; c < 3; ++c)
                        sum[c] += weight * light.at(i, j, c);
                }
            }
            for (int c = 0; c < 3; ++c)
                small.at(x, y, c) = static_cast<float>(sum[c] / weights);
        }
    }
    return small;
}

/// Computes the formula of McCamy 1992, "Correlated color temperature as an explicit function of
/// chromaticity coordinates".
std::optional<double> color_temperature_of(Double3 rgb) {
    // Linear sRGB to CIE XYZ (IEC 61966-2-1).
    const double x = glm::dot(rgb, Double3(0.4124, 0.3576, 0.1805));
    const double y = glm::dot(rgb, Double3(0.2126, 0.7152, 0.0722));
    const double z = glm::dot(rgb, Double3(0.0193, 0.1192, 0.9505));
    const double sum = x + y + z;
    if (!(sum > 0)) return std::nullopt;
    const double n = (x / sum - 0.3320) / (0.1858 - y / sum);
    const double kelvin = ((449 * n + 3525) * n + 6823.3) * n + 5520.33;
    if (!(kelvin >= 1000 && kelvin <= 40000)) return std::nullopt;
    return kelvin;
}

std::optional<double> dynamic_range_of(const Image& light) {
    std::vector<std::pair<double, double>> texels;  // luminance, solid angle
    texels.reserve(light.pixels.size() / 3);
    double sphere = 0;
    for (int y = 0; y < light.height; ++y) {
        const double weight = solid_angle_of_row(light, y);
        for (int x = 0; x < light.width; ++x) {
            texels.emplace_back(luminance(radiance_at(light, x, y)), weight);
            sphere += weight;
        }
    }
    std::sort(texels.begin(), texels.end());
    double below = 0;
    for (const auto& [value, weight] : texels) {
        below += weight;
        if (below < 0.01 * sphere) continue;
        if (value <= 0) return std::nullopt;
        return std::log2(texels.back().first / value);
    }
    return std::nullopt;
}

}  // namespace

Vec3 to_direction(SkyAngles angles) {
    const float azimuth = angles.azimuth * pi / 180;
    const float elevation = angles.elevation * pi / 180;
    return Vec3(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                -std::cos(elevation) * std::cos(azimuth));
}

SkyAngles to_sky_angles(Vec3 direction) {
    const Vec3 d = glm::normalize(direction);
    SkyAngles angles;
    angles.elevation = std::asin(std::clamp(d.y, -1.0f, 1.0f)) * 180 / pi;
    // At the poles the azimuth is arbitrary, and rounding would determine it.
    if (std::hypot(d.x, d.z) > 1e-5f) angles.azimuth = std::atan2(d.x, -d.z) * 180 / pi;
    if (angles.azimuth < 0) angles.azimuth += 360;
    return angles;
}

double luminance(glm::dvec3 rgb) {
    return glm::dot(rgb, Double3(0.2126, 0.7152, 0.0722));
}

double LightLobe::radius() const {
    return std::acos(std::clamp(1 - solid_angle / (2 * M_PI), -1.0, 1.0));
}

bool LightLobe::is_sun() const {
    return radius() <= 5 * M_PI / 180 && share >= 0.03;
}

LightLobe brightest_lobe(const Image& light) {
    ITEM3D_CHECK(light.channels == 3 && !light.empty(), "a light has three channels");
    const int width = light.width;
    const int height = light.height;
    LightLobe lobe;
    lobe.texels.assign(static_cast<std::size_t>(width) * height, false);
    double brightest = 0;
    std::pair<int, int> start{0, 0};
    double energy = 0;
    for (int y = 0; y < height; ++y) {
        const double weight = solid_angle_of_row(light, y);
        for (int x = 0; x < width; ++x) {
            const double value = luminance(radiance_at(light, x, y));
            energy += weight * value;
            if (value > brightest) {
                brightest = value;
                start = {x, y};
            }
        }
    }
    if (brightest <= 0) return lobe;

    std::vector<std::pair<int, int>> open;
    const auto visit = [&](int x, int y) {
        const std::size_t index = static_cast<std::size_t>(y) * width + x;
        if (lobe.texels[index] || luminance(radiance_at(light, x, y)) < 0.1 * brightest) return;
        lobe.texels[index] = true;
        open.emplace_back(x, y);
    };
    Double3 direction(0);
    double lobe_energy = 0;
    visit(start.first, start.second);
    while (!open.empty()) {
        const auto [x, y] = open.back();
        open.pop_back();
        const double weight = solid_angle_of_row(light, y);
        const Double3 radiance = radiance_at(light, x, y);
        lobe.solid_angle += weight;
        lobe.irradiance += weight * radiance;
        lobe_energy += weight * luminance(radiance);
        direction += weight * luminance(radiance) * Double3(direction_at(light, x, y));
        for (int dy = -1; dy <= 1; ++dy) {
            if (y + dy < 0 || y + dy >= height) {
                // All texels of the row at a pole are neighbours.
                for (int other = 0; other < width; ++other)
                    visit(other, y);
                continue;
            }
            for (int dx = -1; dx <= 1; ++dx)
                visit((x + dx + width) % width, y + dy);
        }
    }
    if (glm::length(direction) > 1e-9 * lobe_energy)
        lobe.direction = Vec3(glm::normalize(direction));
    lobe.share = lobe_energy / energy;
    return lobe;
}

LightDescription describe_light(const Image& light) {
    LightDescription description;
    description.lobe = brightest_lobe(light);
    description.mean_radiance = mean_radiance(light);
    Double3 direction(0);
    double energy = 0;
    for (int y = 0; y < light.height; ++y) {
        const double weight = solid_angle_of_row(light, y);
        for (int x = 0; x < light.width; ++x) {
            const Double3 radiance = radiance_at(light, x, y);
            energy += weight * luminance(radiance);
            direction += weight * luminance(radiance) * Double3(direction_at(light, x, y));
        }
    }
    if (energy > 0) description.directionality = glm::length(direction) / energy;
    if (description.directionality > 1e-6)
        description.dominant_direction = Vec3(glm::normalize(direction));
    description.color_temperature = color_temperature_of(description.mean_radiance);
    description.dynamic_range = dynamic_range_of(light);
    description.peak_irradiance_over_pi = peak_irradiance_over_pi(light);
    return description;
}

glm::dvec3 mean_radiance(const Image& light) {
    Double3 sum(0);
    for (int y = 0; y < light.height; ++y) {
        const double weight = solid_angle_of_row(light, y);
        for (int x = 0; x < light.width; ++x)
            sum += weight * radiance_at(light, x, y);
    }
    return sum / (4 * M_PI);
}

float peak_irradiance_over_pi(const Image& light) {
    const Image small = shrink(light);
    // This is irradiance_over_pi() for many normals, with directions of the texels computed once.
    std::vector<Vec3> directions;
    std::vector<double> radiance;  // mean of the channels, times solid angle
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
            directions.push_back(direction_at(small, x, y));
            const Double3 rgb = radiance_at(small, x, y);
            radiance.push_back((rgb.x + rgb.y + rgb.z) / 3 * solid_angle_of_row(small, y));
        }
    }
    constexpr int normals = 256;
    double largest = 0;
    for (int i = 0; i < normals; ++i) {
        // A Fibonacci spiral covers the sphere evenly.
        const float y = 1 - (2 * i + 1.0f) / normals;
        const float radius = std::sqrt(1 - y * y);
        const float angle = 2.39996323f * static_cast<float>(i);
        const Vec3 normal(radius * std::cos(angle), y, radius * std::sin(angle));
        double sum = 0;
        for (std::size_t texel = 0; texel < directions.size(); ++texel)
            sum += radiance[texel] * std::max(0.0f, glm::dot(directions[texel], normal));
        largest = std::max(largest, sum / M_PI);
    }
    return static_cast<float>(largest);
}

}  // namespace item3d
