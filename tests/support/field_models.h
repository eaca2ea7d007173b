// Small models for the tests of src/item3d/field.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/model.h"

#include <cmath>

namespace item3d::testing {

/// Returns a sphere of radius 1 with a UV map of one chart (longitude, latitude), inside [0, 1].
inline Primitive make_sphere(int columns = 32, int rows = 16) {
    Primitive sphere;
    sphere.name = "sphere";
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            const float u = static_cast<float>(i) / static_cast<float>(columns);
            const float v = static_cast<float>(j) / static_cast<float>(rows);
            const float around = 2.0f * pi * u, down = pi * v;
            const Vec3 p(std::sin(down) * std::sin(around), std::cos(down),
                         std::sin(down) * std::cos(around));
            sphere.positions.push_back(p);
            sphere.normals.push_back(p);
            sphere.uvs.push_back(Vec2(u, v));
        }
    }
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const auto at = [&](int x, int y) {
                return static_cast<std::uint32_t>(y * (columns + 1) + x);
            };
            if (j > 0) {
                sphere.indices.insert(sphere.indices.end(),
                                      {at(i, j), at(i + 1, j + 1), at(i + 1, j)});
            }
            if (j < rows - 1) {
                sphere.indices.insert(sphere.indices.end(),
                                      {at(i, j), at(i, j + 1), at(i + 1, j + 1)});
            }
        }
    }
    return sphere;
}

/// Returns the square [-1, 1]^2 in the plane z = 0 with UVs in [low, high].
inline Primitive make_quad(Vec2 low = Vec2(0.0f), Vec2 high = Vec2(1.0f),
                           Vec3 offset = Vec3(0.0f)) {
    Primitive quad;
    quad.name = "quad";
    for (int i = 0; i < 4; ++i) {
        const float x = static_cast<float>(i & 1), y = static_cast<float>(i >> 1);
        quad.positions.push_back(Vec3(2.0f * x - 1.0f, 2.0f * y - 1.0f, 0.0f) + offset);
        quad.normals.push_back(Vec3(0.0f, 0.0f, 1.0f));
        quad.uvs.push_back(Vec2(low.x + x * (high.x - low.x), high.y + y * (low.y - high.y)));
    }
    quad.indices = {0, 1, 3, 0, 3, 2};
    return quad;
}

/// Returns an image of coloured blobs with a fine pattern, whose values are multiples of 1/255.
inline Image make_colors(int size) {
    Image image(size, size, 3);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const float u = static_cast<float>(x) / static_cast<float>(size);
            const float v = static_cast<float>(y) / static_cast<float>(size);
            const bool line = (x / 4 + y / 4) % 4 == 0;
            const float values[3] = {0.6f + 0.3f * std::sin(2.0f * pi * u) * std::sin(pi * v),
                                     0.4f + 0.3f * std::cos(2.0f * pi * u) * std::sin(pi * v),
                                     line ? 0.3f : 0.2f};
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = std::round(values[c] * 255.0f) / 255.0f;
        }
    }
    return image;
}

inline Image make_orm(int size) {
    Image image(size, size, 3);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const float v = static_cast<float>(y) / static_cast<float>(size);
            const float values[3] = {1.0f - 0.3f * v, 0.3f + 0.5f * v, x < size / 2 ? 0.0f : 1.0f};
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = std::round(values[c] * 255.0f) / 255.0f;
        }
    }
    return image;
}

/// Returns a model of one primitive with a base colour and an occlusion-roughness-metallic texture.
inline Model make_model(Primitive primitive, int texture_size = 64) {
    Model model;
    model.primitives.push_back(std::move(primitive));
    Material material;
    material.name = "paint";
    material.base_color_texture = 0;
    material.metallic_roughness_texture = 1;
    material.occlusion_texture = 1;
    model.materials.push_back(material);
    Texture colors, orm;
    colors.image = make_colors(texture_size);
    orm.image = make_orm(texture_size);
    model.textures = {colors, orm};
    return model;
}

}  // namespace item3d::testing
