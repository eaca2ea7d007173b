// Vertex attributes at covered pixels, and the gradient of perspective-correct interpolation.
//
//     value = b_0 a_0 + b_1 a_1 + b_2 a_2        b_2 = 1 - b_0 - b_1
//
// with the attributes a_k of the triangle's corners. The barycentrics b_k are corrected for
// perspective (barycentrics.h). In the backward pass, let g be the gradient with respect to the
// value. The gradient with respect to a_k is b_k g, and that with respect to b_k is g . a_k. From
// the latter, weights_backward() computes the gradient with respect to the vertices in clip space.
//
//     attributes    [V, A]            triangles  [T, 3]
//     barycentrics  [N, H, W, 2]      pixel      [P] indices into N H W of the covered pixels
//     values        [P, A]            one row for each covered pixel, in their order
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/host_device.h"
#include "item3d/core/math.h"
#include "item3d/render/kernels/barycentrics.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

struct SurfaceParameters {
    const float* positions;                  ///< [V, 3]
    const float* normals;                    ///< [V, 3]
    const float* tangents;                   ///< [V, 4]
    const float* uvs;                        ///< [V, 2]
    const float* colors;                     ///< [V, 4]
    const std::int32_t* triangles;           ///< [T, 3]
    const std::int32_t* triangle_material;   ///< [T]
    const std::int32_t* triangle_primitive;  ///< [T]
    const float* barycentrics;               ///< [N, H, W, 2]
    const std::int32_t* triangle;            ///< [N, H, W]
    const float* camera_positions;           ///< [N, 3] world space
    std::int64_t pixels_per_view;            ///< H * W
    const std::int64_t* pixel;               ///< [P]
    float* position;                         ///< [P, 3]
    float* normal;                           ///< [P, 3]
    float* tangent;                          ///< [P, 4]
    float* uv;                               ///< [P, 2]
    float* color;                            ///< [P, 4]
    float* view;                             ///< [P, 3]
    std::int64_t* material;                  ///< [P]
    std::int64_t* primitive;                 ///< [P]
};

template <int Channels>
ITEM3D_HOST_DEVICE inline void interpolate_attribute(const float* attribute,
                                                     const std::int32_t* corners,
                                                     const float* weights, float* out) {
    for (int c = 0; c < Channels; ++c) {
        float sum = 0;
        for (int k = 0; k < 3; ++k)
            sum += weights[k] * attribute[Channels * static_cast<std::int64_t>(corners[k]) + c];
        out[c] = sum;
    }
}

ITEM3D_HOST_DEVICE inline Vec3 load3(const float* p) {
    return Vec3(p[0], p[1], p[2]);
}
ITEM3D_HOST_DEVICE inline void store3(float* p, Vec3 v) {
    p[0] = v.x;
    p[1] = v.y;
    p[2] = v.z;
}
/// Returns the unit vector in the direction of v, or zero if v is zero.
ITEM3D_HOST_DEVICE inline Vec3 safe_normalize(Vec3 v) {
    const float squared = glm::dot(v, v);
    return squared > 1e-37f ? v / std::sqrt(squared) : Vec3(0.0f);
}

/// Interpolates one surface point, and flips the shading normal to the viewer's side of the
/// triangle. The test uses the triangle's own plane. It does not use the interpolated normal, so
/// that normals that bend away near a silhouette are kept. It does not use the winding, so that
/// wrongly wound meshes look right.
ITEM3D_HOST_DEVICE inline void interpolate_surface_point(const SurfaceParameters& p,
                                                         std::int64_t index) {
    const std::int64_t pixel = p.pixel[index];
    const std::int64_t t = p.triangle[pixel];
    const std::int32_t* corners = p.triangles + 3 * t;
    const float b0 = p.barycentrics[2 * pixel], b1 = p.barycentrics[2 * pixel + 1];
    const float weights[3] = {b0, b1, 1.0f - b0 - b1};

    interpolate_attribute<3>(p.positions, corners, weights, p.position + 3 * index);
    interpolate_attribute<3>(p.normals, corners, weights, p.normal + 3 * index);
    interpolate_attribute<4>(p.tangents, corners, weights, p.tangent + 4 * index);
    interpolate_attribute<2>(p.uvs, corners, weights, p.uv + 2 * index);
    interpolate_attribute<4>(p.colors, corners, weights, p.color + 4 * index);
    p.material[index] = p.triangle_material[t];
    p.primitive[index] = p.triangle_primitive[t];

    const Vec3 position = load3(p.position + 3 * index);
    const Vec3 camera = load3(p.camera_positions + 3 * (pixel / p.pixels_per_view));
    const Vec3 view = safe_normalize(camera - position);
    store3(p.view + 3 * index, view);

    const Vec3 v0 = load3(p.positions + 3 * static_cast<std::int64_t>(corners[0]));
    const Vec3 v1 = load3(p.positions + 3 * static_cast<std::int64_t>(corners[1]));
    const Vec3 v2 = load3(p.positions + 3 * static_cast<std::int64_t>(corners[2]));
    const Vec3 face = glm::cross(v1 - v0, v2 - v0);
    Vec3 normal = load3(p.normal + 3 * index);
    if (!(glm::dot(normal, normal) > 1e-20f)) normal = face;
    normal = safe_normalize(normal);
    float* tangent = p.tangent + 4 * index;
    // The handedness across a mirrored seam must not pass through zero between vertices.
    if (tangent[3] != 0) tangent[3] = tangent[3] < 0 ? -1.0f : 1.0f;
    if (glm::dot(normal, face) * glm::dot(view, face) < 0) {
        // The whole tangent frame flips, as glTF requires for double-sided materials.
        normal = -normal;
        for (int c = 0; c < 4; ++c)
            tangent[c] = -tangent[c];
    }
    store3(p.normal + 3 * index, normal);
}

struct InterpolateParameters {
    const float* attributes;        ///< [V, A]
    const float* positions_clip;    ///< [N, V, 4]
    const std::int32_t* triangles;  ///< [T, 3]
    const float* barycentrics;      ///< [N, H, W, 2]
    const std::int32_t* triangle;   ///< [N, H, W]
    const std::int64_t* pixel;      ///< [P]
    std::int64_t vertices;          ///< V
    int channels;                   ///< A
    int width;
    int height;
    float* values;                   ///< [P, A]
    const float* value_gradient;     ///< [P, A]
    Accumulator attribute_gradient;  ///< [V, A]
    Accumulator clip_gradient;       ///< [N, V, 4]
};

ITEM3D_HOST_DEVICE inline void interpolate_forward(const InterpolateParameters& p,
                                                   std::int64_t index) {
    const std::int64_t pixel = p.pixel[index];
    const std::int32_t* corners = p.triangles + 3 * static_cast<std::int64_t>(p.triangle[pixel]);
    const float b0 = p.barycentrics[2 * pixel], b1 = p.barycentrics[2 * pixel + 1];
    const float weights[3] = {b0, b1, 1.0f - b0 - b1};
    for (int c = 0; c < p.channels; ++c) {
        float sum = 0;
        for (int k = 0; k < 3; ++k)
            sum +=
                weights[k] * p.attributes[p.channels * static_cast<std::int64_t>(corners[k]) + c];
        p.values[p.channels * index + c] = sum;
    }
}

/// Adds one pixel's gradients with respect to attributes and vertices. On the CPU, concurrent calls
/// are unsafe if they share vertices.
ITEM3D_HOST_DEVICE inline void interpolate_backward(const InterpolateParameters& p,
                                                    std::int64_t index) {
    const std::int64_t pixel = p.pixel[index];
    const std::int32_t* corners = p.triangles + 3 * static_cast<std::int64_t>(p.triangle[pixel]);
    const float b0 = p.barycentrics[2 * pixel], b1 = p.barycentrics[2 * pixel + 1];
    const float weights[3] = {b0, b1, 1.0f - b0 - b1};
    const float* gradient = p.value_gradient + p.channels * index;

    double weight_gradient[3] = {0, 0, 0};
    for (int k = 0; k < 3; ++k) {
        const std::int64_t row = p.channels * static_cast<std::int64_t>(corners[k]);
        for (int c = 0; c < p.channels; ++c) {
            p.attribute_gradient.add(row + c, weights[k] * gradient[c]);
            weight_gradient[k] += static_cast<double>(gradient[c]) * p.attributes[row + c];
        }
    }
    if (!p.clip_gradient.wanted()) return;

    const std::int64_t per_view = static_cast<std::int64_t>(p.width) * p.height;
    const std::int64_t view = pixel / per_view;
    const int y = static_cast<int>(pixel % per_view / p.width);
    const int x = static_cast<int>(pixel % p.width);
    DVec3 position_gradient[3];
    if (!weights_backward(ClipTriangle(p.positions_clip + 4 * view * p.vertices, corners),
                          pixel_centre(x, y, p.width, p.height), weights, weight_gradient, nullptr,
                          p.width, p.height, position_gradient))
        return;
    for (int k = 0; k < 3; ++k) {
        const std::int64_t row = 4 * (view * p.vertices + static_cast<std::int64_t>(corners[k]));
        p.clip_gradient.add(row, static_cast<float>(position_gradient[k].x));
        p.clip_gradient.add(row + 1, static_cast<float>(position_gradient[k].y));
        p.clip_gradient.add(row + 3, static_cast<float>(position_gradient[k].z));
    }
}

}  // namespace item3d::kernels
