// Cube maps: OpenGL's face order and orientation, and bilinear lookups without seams.
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/host_device.h"
#include "item3d/core/math.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

/// Direction of face coordinates s, t in [-1, 1] (s grows to the right, t downwards); not unit.
ITEM3D_HOST_DEVICE inline Vec3 cube_direction(int face, float s, float t) {
    switch (face) {
        case 0:
            return Vec3(1, -t, -s);
        case 1:
            return Vec3(-1, -t, s);
        case 2:
            return Vec3(s, 1, t);
        case 3:
            return Vec3(s, -1, -t);
        case 4:
            return Vec3(s, -t, 1);
        default:
            return Vec3(-s, -t, -1);
    }
}

/// Unit vectors along s, t and the face's normal.
struct CubeFrame {
    Vec3 s, t, normal;
};

ITEM3D_HOST_DEVICE inline CubeFrame cube_frame(int face) {
    const Vec3 normal = cube_direction(face, 0, 0);
    return {cube_direction(face, 1, 0) - normal, cube_direction(face, 0, 1) - normal, normal};
}

ITEM3D_HOST_DEVICE inline int cube_face(Vec3 d) {
    const float x = std::fabs(d.x), y = std::fabs(d.y), z = std::fabs(d.z);
    if (x >= y && x >= z) return d.x < 0 ? 1 : 0;
    if (y >= z) return d.y < 0 ? 3 : 2;
    return d.z < 0 ? 5 : 4;
}

/// Centre of texel i of `size`, in [-1, 1].
ITEM3D_HOST_DEVICE inline float texel_centre(int i, int size) {
    return (2 * i + 1) / static_cast<float>(size) - 1.0f;
}

/// Four texels of a [6, size, size] map with bilinear weights and the weights' derivatives by the
/// texel coordinates x, y.
struct CubeTaps {
    std::int32_t texel[4];
    float weight[4];
    float weight_x[4];
    float weight_y[4];
    Vec3 gradient_x;  ///< of texel coordinate x by direction
    Vec3 gradient_y;
};

/// The texel beyond the edge of a face: x or y (not both) is -1 or size.
ITEM3D_HOST_DEVICE inline std::int32_t texel_over_edge(const CubeFrame& frame, int x, int y,
                                                       int size) {
    // Its centre lies one unit along the axis that was left, half a texel below the edge.
    const float inner = 1.0f - 1.0f / size;
    const Vec3 d =
        x < 0 || x >= size
            ? (x < 0 ? -frame.s : frame.s) + texel_centre(y, size) * frame.t + inner * frame.normal
            : (y < 0 ? -frame.t : frame.t) + texel_centre(x, size) * frame.s + inner * frame.normal;
    const int face = cube_face(d);
    const CubeFrame other = cube_frame(face);
    const float s = glm::dot(other.s, d), t = glm::dot(other.t, d);
    int column = static_cast<int>((s + 1) * 0.5f * size);
    int row = static_cast<int>((t + 1) * 0.5f * size);
    column = column < 0 ? 0 : (column >= size ? size - 1 : column);
    row = row < 0 ? 0 : (row >= size ? size - 1 : row);
    return (face * size + row) * size + column;
}

ITEM3D_HOST_DEVICE inline CubeTaps cube_taps(Vec3 d, int size) {
    CubeTaps taps;
    const int face = cube_face(d);
    const CubeFrame frame = cube_frame(face);
    const float inverse = 1.0f / glm::dot(frame.normal, d);
    const float s = glm::dot(frame.s, d) * inverse, t = glm::dot(frame.t, d) * inverse;
    const float half = 0.5f * size;
    taps.gradient_x = (frame.s - s * frame.normal) * (half * inverse);
    taps.gradient_y = (frame.t - t * frame.normal) * (half * inverse);

    const float x = s * half + half - 0.5f, y = t * half + half - 0.5f;
    const int x0 = static_cast<int>(x + 1.0f) - 1, y0 = static_cast<int>(y + 1.0f) - 1;
    const float fx = x - x0, fy = y - y0;
    const float wx[2] = {1 - fx, fx}, wy[2] = {1 - fy, fy};
    int corner = -1;
    for (int i = 0; i < 4; ++i) {
        const int column = x0 + (i & 1), row = y0 + (i >> 1);
        const bool out_x = column < 0 || column >= size, out_y = row < 0 || row >= size;
        taps.weight[i] = wx[i & 1] * wy[i >> 1];
        taps.weight_x[i] = ((i & 1) ? 1.0f : -1.0f) * wy[i >> 1];
        taps.weight_y[i] = ((i >> 1) ? 1.0f : -1.0f) * wx[i & 1];
        if (out_x && out_y) {
            corner = i;
            taps.texel[i] = 0;
        } else if (out_x || out_y) {
            taps.texel[i] = texel_over_edge(frame, column, row, size);
        } else {
            taps.texel[i] = (face * size + row) * size + column;
        }
    }
    if (corner >= 0) {
        // Three texels meet at a cube's corner; the fourth is their mean.
        for (int i = 0; i < 4; ++i) {
            if (i == corner) continue;
            taps.weight[i] += taps.weight[corner] / 3;
            taps.weight_x[i] += taps.weight_x[corner] / 3;
            taps.weight_y[i] += taps.weight_y[corner] / 3;
        }
        taps.weight[corner] = taps.weight_x[corner] = taps.weight_y[corner] = 0;
    }
    return taps;
}

ITEM3D_HOST_DEVICE inline Vec3 cube_value(const float* map, const CubeTaps& taps) {
    Vec3 value(0.0f);
    for (int i = 0; i < 4; ++i) {
        const float* texel = map + 3 * taps.texel[i];
        value += taps.weight[i] * Vec3(texel[0], texel[1], texel[2]);
    }
    return value;
}

/// Gradient by the direction of dot(gradient, cube_value).
ITEM3D_HOST_DEVICE inline Vec3 cube_direction_gradient(const float* map, const CubeTaps& taps,
                                                       Vec3 gradient) {
    float by_x = 0, by_y = 0;
    for (int i = 0; i < 4; ++i) {
        const float* texel = map + 3 * taps.texel[i];
        const float value = glm::dot(gradient, Vec3(texel[0], texel[1], texel[2]));
        by_x += taps.weight_x[i] * value;
        by_y += taps.weight_y[i] * value;
    }
    return by_x * taps.gradient_x + by_y * taps.gradient_y;
}

/// first: where the map's gradient begins in `sums`.
ITEM3D_HOST_DEVICE inline void cube_add_gradient(const Accumulator& sums, std::int64_t first,
                                                 const CubeTaps& taps, Vec3 gradient) {
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c)
            sums.add(first + 3 * taps.texel[i] + c, taps.weight[i] * gradient[c]);
}

}  // namespace item3d::kernels
