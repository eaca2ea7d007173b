#include "item3d/io/gltf/specular_glossiness.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr float dielectric = 0.04f;

struct MetalPoint {
    Vec3 base_color;
    float metallic;
};

float perceived_brightness(const Vec3& color) {
    return std::sqrt(glm::dot(color * color, Vec3(0.299f, 0.587f, 0.114f)));
}

/// Solves diffuse = base (1 - dielectric) (1 - m) and specular = lerp(dielectric, base, m) for m,
/// as in the extension's own conversion.
float solve_metallic(float diffuse, float specular, float one_minus_specular) {
    if (specular <= dielectric) return 0.0f;
    const float b = diffuse * one_minus_specular / (1.0f - dielectric) + specular - 2 * dielectric;
    const float c = dielectric - specular;
    const float under_root = std::max(0.0f, b * b - 4 * dielectric * c);
    return std::clamp((-b + std::sqrt(under_root)) / (2 * dielectric), 0.0f, 1.0f);
}

MetalPoint convert(const Vec3& diffuse, const Vec3& specular) {
    constexpr float minimum = 1e-4f;
    const float one_minus_specular = 1.0f - std::max({specular.x, specular.y, specular.z});
    const float m = solve_metallic(perceived_brightness(diffuse), perceived_brightness(specular),
                                   one_minus_specular);
    const Vec3 of_diffuse =
        diffuse * (one_minus_specular / (1.0f - dielectric) / std::max(1.0f - m, minimum));
    const Vec3 of_specular =
        (specular - Vec3(dielectric * (1.0f - m))) * (1.0f / std::max(m, minimum));
    return {glm::clamp(glm::mix(of_diffuse, of_specular, m * m), 0.0f, 1.0f), m};
}

/// Returns an image's texel at the position of a texel (x, y) in an image of width x height.
const float* texel_at(const Image& image, int x, int y, int width, int height) {
    const int column = std::min(image.width - 1, (2 * x + 1) * image.width / (2 * width));
    const int row = std::min(image.height - 1, (2 * y + 1) * image.height / (2 * height));
    return &image.pixels[(static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                          static_cast<std::size_t>(column)) *
                         static_cast<std::size_t>(image.channels)];
}

Vec3 linear_color(const Image& image, const float* texel) {
    const bool grey = image.channels < 3;
    return Vec3(srgb_to_linear(texel[0]), srgb_to_linear(texel[grey ? 0 : 1]),
                srgb_to_linear(texel[grey ? 0 : 2]));
}

}  // namespace

MetallicRoughness to_metallic_roughness(const SpecularGlossiness& source) {
    MetallicRoughness result;
    const Vec3 specular = source.specular_factor;
    const bool is_plain = source.specular_glossiness == nullptr &&
                          std::max({specular.x, specular.y, specular.z}) <= dielectric + 0.01f;
    result.roughness_factor = 1.0f - source.glossiness_factor;
    result.base_color_factor = source.diffuse_factor;
    if (is_plain) return result;
    if (source.diffuse == nullptr && source.specular_glossiness == nullptr) {
        const MetalPoint point = convert(Vec3(source.diffuse_factor), specular);
        result.base_color_factor = Vec4(point.base_color, source.diffuse_factor.w);
        result.metallic_factor = point.metallic;
        return result;
    }
    const Image& larger = source.diffuse != nullptr ? *source.diffuse : *source.specular_glossiness;
    const int width = larger.width, height = larger.height;
    const int alpha_channel = source.diffuse != nullptr && source.diffuse->channels % 2 == 0
                                  ? source.diffuse->channels - 1
                                  : -1;
    Image base(width, height, alpha_channel < 0 ? 3 : 4);
    Image orm(width, height, 3, 1.0f);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            Vec3 diffuse(source.diffuse_factor), shine = specular;
            float glossiness = source.glossiness_factor;
            if (source.diffuse != nullptr) {
                const float* texel = texel_at(*source.diffuse, x, y, width, height);
                diffuse *= linear_color(*source.diffuse, texel);
                if (alpha_channel >= 0) base.at(x, y, 3) = texel[alpha_channel];
            }
            if (source.specular_glossiness != nullptr) {
                const Image& image = *source.specular_glossiness;
                const float* texel = texel_at(image, x, y, width, height);
                shine *= linear_color(image, texel);
                if (image.channels % 2 == 0) glossiness *= texel[image.channels - 1];
            }
            const MetalPoint point = convert(diffuse, shine);
            for (int c = 0; c < 3; ++c)
                base.at(x, y, c) = linear_to_srgb(point.base_color[c]);
            orm.at(x, y, 1) = 1.0f - glossiness;
            orm.at(x, y, 2) = point.metallic;
        }
    }
    result.base_color_factor = Vec4(Vec3(1.0f), source.diffuse_factor.w);
    result.metallic_factor = result.roughness_factor = 1.0f;
    result.base_color = std::move(base);
    result.metallic_roughness = std::move(orm);
    return result;
}

}  // namespace item3d
