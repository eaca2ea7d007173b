// Cube maps: OpenGL's face order and orientation, and seamless bilinear lookups.
//
// A face has axes S, T and a normal N; a direction d meets it at s = d.S / d.N, t = d.T / d.N, so
//
//     d s / d d = (S - s N) / d.N        (and t alike: cube_direction_gradient)
//
//     face   0: +X   1: -X   2: +Y   3: -Y   4: +Z   5: -Z          +------+
//     S       -Z      +Z      +X      +X      +X      -X            |  +Y  |
//     T       -Y      -Y      +Z      -Z      -Y      -Y     +------+------+------+------+
//                                                            |  -X  |  +Z  |  +X  |  -Z  |
//     maps  [6, size, size, 3]      row: t, column: s        +------+------+------+------+
//     texel i lies at (2 i + 1) / size - 1 of its face              |  -Y  |
//                                                                   +------+
// A tap beyond an edge is the adjacent texel of the neighbouring face, unfolded over the edge. At a
// corner, where three texels meet, the fourth tap is the mean of the three. So values are
// continuous everywhere.
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/host_device.h"
#include "item3d/core/math.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

/// Returns the direction, not of unit length, of face coordinates s, t in [-1, 1]. s grows to the
/// right and t downwards.
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

/// Returns the coordinate, in [-1, 1], of the centre of texel i in a row of `size` texels.
ITEM3D_HOST_DEVICE inline float texel_centre(int i, int size) {
    return (2 * i + 1) / static_cast<float>(size) - 1.0f;
}

/// Four texels of a [6, size, size] map with bilinear weights.
struct CubeTaps {
    std::int32_t texel[4];
    float weight[4];
    // For cube_direction_gradient():
    int face;
    /// The tap beyond a cube's corner, whose weight goes to the other three taps; -1 if there is
    /// none.
    int corner;
    float s, t;       ///< face coordinates of the direction
    float x, y;       ///< fractions towards the right and down
    float texels_by;  ///< texels on the face per unit of direction along s or t
};

/// Face coordinates of a direction, multiplied by `major`.
struct FaceCoordinates {
    float s, t, major;
};

ITEM3D_HOST_DEVICE inline FaceCoordinates face_coordinates(int face, Vec3 d) {
    switch (face) {
        case 0:
            return {-d.z, -d.y, d.x};
        case 1:
            return {d.z, -d.y, -d.x};
        case 2:
            return {d.x, d.z, d.y};
        case 3:
            return {d.x, -d.z, -d.y};
        case 4:
            return {d.x, -d.y, d.z};
        default:
            return {-d.x, -d.y, -d.z};
    }
}

/// Returns the index of the texel beyond the edge of a face. One of x and y, but not both, is -1 or
/// `size`.
ITEM3D_HOST_DEVICE inline std::int32_t texel_over_edge(const CubeFrame& frame, int x, int y,
                                                       int size) {
    // The texel's centre is at 1 along the axis whose range was left, half a texel from the edge.
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

/// Intersection of a direction with the cube. Lookups in maps of all sizes share it.
struct CubePoint {
    int face;
    float s, t;
    float inverse;  ///< face coordinates per unit of direction along s or t
};

ITEM3D_HOST_DEVICE inline CubePoint cube_point(Vec3 d) {
    const int face = cube_face(d);
    const FaceCoordinates on_face = face_coordinates(face, d);
    const float inverse = 1.0f / on_face.major;
    return {face, on_face.s * inverse, on_face.t * inverse, inverse};
}

ITEM3D_HOST_DEVICE inline CubeTaps cube_taps(const CubePoint& point, int size) {
    const float half = 0.5f * size;
    CubeTaps taps;
    taps.face = point.face;
    taps.corner = -1;
    taps.s = point.s;
    taps.t = point.t;
    taps.texels_by = half * point.inverse;

    const float x = taps.s * half + half - 0.5f, y = taps.t * half + half - 0.5f;
    // A direction that is zero or not finite has no point on the cube. Its value is NaN, but its
    // texels lie in the map.
    const auto texel_before = [size](float place) {
        return place > -1.0f && place < size ? static_cast<int>(place + 1.0f) - 1 : 0;
    };
    const int x0 = texel_before(x), y0 = texel_before(y);
    taps.x = x - x0;
    taps.y = y - y0;
    taps.weight[0] = (1 - taps.x) * (1 - taps.y);
    taps.weight[1] = taps.x * (1 - taps.y);
    taps.weight[2] = (1 - taps.x) * taps.y;
    taps.weight[3] = taps.x * taps.y;
    if (x0 >= 0 && y0 >= 0 && x0 + 1 < size && y0 + 1 < size) {
        taps.texel[0] = (taps.face * size + y0) * size + x0;
        taps.texel[1] = taps.texel[0] + 1;
        taps.texel[2] = taps.texel[0] + size;
        taps.texel[3] = taps.texel[2] + 1;
        return taps;
    }
    const CubeFrame frame = cube_frame(taps.face);
    for (int i = 0; i < 4; ++i) {
        const int column = x0 + (i & 1), row = y0 + (i >> 1);
        const bool out_x = column < 0 || column >= size, out_y = row < 0 || row >= size;
        if (out_x && out_y) {
            taps.corner = i;
            taps.texel[i] = 0;
        } else if (out_x || out_y) {
            taps.texel[i] = texel_over_edge(frame, column, row, size);
        } else {
            taps.texel[i] = (taps.face * size + row) * size + column;
        }
    }
    if (taps.corner >= 0) {
        // Three texels meet at a cube's corner; the fourth tap is their mean.
        const float share = taps.weight[taps.corner] / 3;
        for (int i = 0; i < 4; ++i)
            taps.weight[i] = i == taps.corner ? 0.0f : taps.weight[i] + share;
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

/// Returns the gradient of dot(gradient, cube_value) with respect to the direction.
ITEM3D_HOST_DEVICE inline Vec3 cube_direction_gradient(const float* map, const CubeTaps& taps,
                                                       Vec3 gradient) {
    float value[4], total = 0;
    for (int i = 0; i < 4; ++i) {
        const float* texel = map + 3 * taps.texel[i];
        value[i] = gradient.x * texel[0] + gradient.y * texel[1] + gradient.z * texel[2];
        total += value[i];
    }
    if (taps.corner >= 0) value[taps.corner] = (total - value[taps.corner]) / 3;
    const float by_x = (1 - taps.y) * (value[1] - value[0]) + taps.y * (value[3] - value[2]);
    const float by_y = (1 - taps.x) * (value[2] - value[0]) + taps.x * (value[3] - value[1]);
    const CubeFrame frame = cube_frame(taps.face);
    return taps.texels_by *
           (by_x * (frame.s - taps.s * frame.normal) + by_y * (frame.t - taps.t * frame.normal));
}

/// Adds the gradient with respect to the map's texels. first: index of the map's gradient in
/// `sums`.
ITEM3D_HOST_DEVICE inline void cube_add_gradient(const Accumulator& sums, std::int64_t first,
                                                 const CubeTaps& taps, Vec3 gradient) {
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c)
            sums.add(first + 3 * taps.texel[i] + c, taps.weight[i] * gradient[c]);
}

}  // namespace item3d::kernels
