#include "item3d/field/bake/source_texels.h"

#include "item3d/core/parallel.h"

namespace item3d {
namespace {

constexpr int rows_at_once = 16;

}  // namespace

void copy_base_color(const Image& texels, const Vec4& factor, Image& image) {
    parallel_for(
        "base_color_texels", texels.height,
        [&](std::int64_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < texels.width; ++x) {
                for (int c = 0; c < 3; ++c) {
                    const float value = texels.at(x, y, texels.channels >= 3 ? c : 0);
                    image.at(x, y, c) = factor[c] == 1.0f
                                            ? value
                                            : linear_to_srgb(srgb_to_linear(value) * factor[c]);
                }
                if (image.channels < 4) continue;
                image.at(x, y, 3) =
                    factor.w *
                    (texels.channels % 2 == 0 ? texels.at(x, y, texels.channels - 1) : 1.0f);
            }
        },
        rows_at_once);
}

void copy_orm(const OrmTexels& texels, const Material& material, Image& image) {
    const Image* occlusion_texels = texels.occlusion;
    const Image* orm_texels = texels.roughness_metallic;
    const float strength = texels.occlusion_strength;
    parallel_for(
        "orm_texels", image.height,
        [&](std::int64_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < image.width; ++x) {
                float& occlusion = image.at(x, y, 0);
                occlusion = occlusion_texels != nullptr ? occlusion_texels->at(x, y, 0) : 1.0f;
                if (strength != 1.0f) occlusion = 1.0f + strength * (occlusion - 1.0f);
                if (orm_texels == nullptr) continue;
                image.at(x, y, 1) = orm_texels->at(x, y, 1) * material.roughness_factor;
                image.at(x, y, 2) = orm_texels->at(x, y, 2) * material.metallic_factor;
            }
        },
        rows_at_once);
}

void copy_normal(const Image* texels, Image& image) {
    parallel_for(
        "normal_texels", image.height,
        [&](std::int64_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < image.width; ++x) {
                for (int c = 0; c < 3; ++c)
                    image.at(x, y, c) =
                        texels != nullptr ? texels->at(x, y, c) : (c == 2 ? 1.0f : 0.5f);
            }
        },
        rows_at_once);
}

}  // namespace item3d
