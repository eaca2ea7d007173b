// Crossings of silhouette edges between two neighbouring pixel centres (Laine et al. 2020, section
// 3.4). The paper tests the edges of the triangle that the nearer of the two pixels shows. Here the
// search continues over inner edges into the adjacent triangles, so that meshes finer than pixels
// are smoothed too.
//
//     foreground     edge    background       u: from the foreground's centre to the other, 0 to 1
//         o ---------/--------- o             v: across; the pair lies on v = 0
//         0         d    1/2    1             a, b: the edge's ends, in pixels
//
//     d = (a.u b.v - b.u a.v) / (b.v - a.v)      the edge's crossing with v = 0
//     d > 1/2:  background += (d - 1/2) (foreground - background)
//     else      foreground += (1/2 - d) (background - foreground)
//
// In both cases the derivative with respect to d is foreground - background. With
// span = b.v - a.v, the derivatives of d are
//
//     d d / d a.u = b.v / span        d d / d a.v = (d - b.u) / span
//     d d / d b.u = -a.v / span       d d / d b.v = (a.u - d) / span
//
// The chain rule through x / w and y / w leads to clip space (crossing_backward()).
//
//     images  [N, H, W, C]        a pair: pixel i with i + 1 (right) or i + W (below)
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/host_device.h"
#include "item3d/core/math.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

struct AntialiasParameters {
    const float* positions_clip;     ///< [N, V, 4]
    const std::int32_t* triangles;   ///< [T, 3]
    const std::int32_t* neighbours;  ///< [T, 3], see Geometry::neighbours
    const std::int32_t* triangle;    ///< [N, H, W]
    const float* depth;              ///< [N, H, W]
    std::int64_t vertices;           ///< V
    int width;
    int height;
    /// Largest number of triangles visited between two centres. With 1, only the nearer pixel's
    /// triangle is visited, as in the paper. The number bounds the time for meshes much finer than
    /// pixels.
    int max_steps = 256;
};

/// One blended pixel pair.
struct Crossing {
    std::int64_t foreground, background;  ///< pixels, indices into N*H*W
    std::int64_t first, second;           ///< ends of the edge, indices into N*V
    float distance;                       ///< d of the formulas above, in [0, 1]
    std::int16_t vertical;                ///< 1 if the pair is vertical
    std::int16_t direction;               ///< +1: the background is to the right or below
};

/// Position of a vertex relative to the foreground's centre, in pixels. u is along the direction to
/// the background, v perpendicular to it.
struct PairCoordinates {
    float u, v;
};

/// Coordinate frame of a pixel pair.
struct PairFrame {
    float centre_x, centre_y;  ///< centre of the foreground, in pixels
    float half_width, half_height;
    bool vertical;
    int direction;

    ITEM3D_HOST_DEVICE PairFrame(const AntialiasParameters& p, const Crossing& crossing)
        : half_width(0.5f * p.width),
          half_height(0.5f * p.height),
          vertical(crossing.vertical != 0),
          direction(crossing.direction) {
        const std::int64_t row = crossing.foreground / p.width;
        centre_x = crossing.foreground - row * p.width + 0.5f;
        centre_y = row % p.height + 0.5f;
    }
    ITEM3D_HOST_DEVICE PairCoordinates at(const float* clip) const {
        const float inverse = 1.0f / clip[3];
        const float x = (clip[0] * inverse + 1) * half_width - centre_x;
        const float y = (1 - clip[1] * inverse) * half_height - centre_y;
        return vertical ? PairCoordinates{direction * y, x} : PairCoordinates{direction * x, y};
    }
};

/// Returns twice the signed area of a triangle on the screen, up to a positive factor. The sign is
/// also right for vertices behind the camera.
ITEM3D_HOST_DEVICE inline double orientation(const float* a, const float* b, const float* c) {
    const double bx = b[0], by = b[1], bw = b[3], cx = c[0], cy = c[1], cw = c[3];
    return a[0] * (by * cw - bw * cy) + a[1] * (bw * cx - bx * cw) + a[3] * (bx * cy - by * cx);
}

/// Finds the silhouette edge between `pixel` and the next pixel to the right or below. Returns
/// false when no such edge crosses the line between their centres.
ITEM3D_HOST_DEVICE inline bool find_crossing(const AntialiasParameters& p, std::int64_t pixel,
                                             bool vertical, Crossing& crossing) {
    const std::int64_t other = pixel + (vertical ? p.width : 1);
    const std::int32_t here = p.triangle[pixel], there = p.triangle[other];
    if (here == there) return false;
    const bool near_here = there < 0 || (here >= 0 && p.depth[pixel] <= p.depth[other]);
    crossing.foreground = near_here ? pixel : other;
    crossing.background = near_here ? other : pixel;
    crossing.vertical = vertical;
    crossing.direction = near_here ? 1 : -1;

    // Distance in pixels by which an edge may miss the pair, so that rounding loses no crossing.
    constexpr float tolerance = 1.0f / 16;
    const std::int64_t view = pixel / (static_cast<std::int64_t>(p.width) * p.height);
    const float* clip = p.positions_clip + 4 * view * p.vertices;
    const PairFrame frame(p, crossing);
    std::int64_t t = near_here ? here : there;
    const std::int64_t last = near_here ? there : here;
    int entered = -1;                 // corner opposite the edge through which the walk entered
    std::int32_t edge[2] = {-1, -1};  // ends of that edge
    PairCoordinates edge_at[2] = {};
    for (int step = 0; step < p.max_steps; ++step) {
        const std::int32_t* corners = p.triangles + 3 * t;
        const float* v[3];
        PairCoordinates at[3];
        for (int k = 0; k < 3; ++k) {
            v[k] = clip + 4 * static_cast<std::int64_t>(corners[k]);
            if (corners[k] == edge[0]) {
                at[k] = edge_at[0];
            } else if (corners[k] == edge[1]) {
                at[k] = edge_at[1];
            } else {
                if (!(v[k][3] > 1e-12f)) return false;
                at[k] = frame.at(v[k]);
            }
        }
        // Finds the edge through which the line v = 0 leaves the triangle.
        int leaves = -1;
        float farthest = -1e30f;
        for (int k = 0; k < 3; ++k) {
            const PairCoordinates a = at[(k + 1) % 3], b = at[(k + 2) % 3];
            if (k == entered || (a.v < 0) == (b.v < 0)) continue;
            const float u = (a.u * b.v - b.u * a.v) / (b.v - a.v);
            if (u > farthest) {
                farthest = u;
                leaves = k;
            }
        }
        if (leaves < 0 || farthest > 1 + tolerance) return false;
        const int first = (leaves + 1) % 3, second = (leaves + 2) % 3;
        const std::int32_t neighbour = p.neighbours[3 * t + leaves];
        bool silhouette = neighbour < 0;
        if (!silhouette) {
            const float* beyond = clip + 4 * static_cast<std::int64_t>(p.triangles[neighbour]);
            silhouette = orientation(v[first], v[second], v[leaves]) *
                             orientation(v[first], v[second], beyond) >
                         0;
        }
        if (silhouette) {
            if (farthest < -tolerance) return false;
            // Each edge is blended along one axis, the one that it crosses more steeply. Blending
            // along both would count a slanted edge's coverage twice.
            const PairCoordinates a = at[first], b = at[second];
            const float along = std::fabs(b.u - a.u), across = std::fabs(b.v - a.v);
            if (vertical ? along >= across : along > across) return false;
            crossing.first = view * p.vertices + corners[first];
            crossing.second = view * p.vertices + corners[second];
            crossing.distance = farthest < 0 ? 0.0f : (farthest > 1 ? 1.0f : farthest);
            return true;
        }
        edge[0] = corners[first];
        edge[1] = corners[second];
        edge_at[0] = at[first];
        edge_at[1] = at[second];
        t = neighbour / 3;
        // The surface is continuous between the centres. On fine meshes this is so nearly
        // everywhere.
        if (t == last) return false;
        entered = neighbour % 3;
    }
    return false;
}

/// Pixel that a crossing changes, its neighbour, and the weight of the neighbour's colour.
struct Blend {
    std::int64_t pixel, other;
    float weight;
};
ITEM3D_HOST_DEVICE inline Blend blend_of(const Crossing& crossing) {
    const float beyond = crossing.distance - 0.5f;
    return beyond > 0 ? Blend{crossing.background, crossing.foreground, beyond}
                      : Blend{crossing.foreground, crossing.background, -beyond};
}

/// Adds the gradient of a crossing's distance d with respect to the edge's ends. clip_gradient: [N,
/// V, 4].
ITEM3D_HOST_DEVICE inline void crossing_backward(const AntialiasParameters& p,
                                                 const Crossing& crossing, float gradient,
                                                 const Accumulator& clip_gradient) {
    if (crossing.distance <= 0 || crossing.distance >= 1) return;
    const bool vertical = crossing.vertical != 0;
    const std::int64_t ends[2] = {crossing.first, crossing.second};
    const PairFrame frame(p, crossing);
    const PairCoordinates at[2] = {frame.at(p.positions_clip + 4 * ends[0]),
                                   frame.at(p.positions_clip + 4 * ends[1])};
    const float span = at[1].v - at[0].v;
    const float u = crossing.distance;
    const PairCoordinates by_end[2] = {{at[1].v / span, (u - at[1].u) / span},
                                       {-at[0].v / span, (at[0].u - u) / span}};
    for (int k = 0; k < 2; ++k) {
        const float along = gradient * by_end[k].u * crossing.direction;
        const float across = gradient * by_end[k].v;
        const float by_x = vertical ? across : along, by_y = vertical ? along : across;
        const float* clip = p.positions_clip + 4 * ends[k];
        const float inverse = 1.0f / clip[3];
        const float x_scale = 0.5f * p.width * inverse, y_scale = -0.5f * p.height * inverse;
        const std::int64_t row = 4 * ends[k];
        clip_gradient.add(row, by_x * x_scale);
        clip_gradient.add(row + 1, by_y * y_scale);
        clip_gradient.add(row + 3,
                          -(by_x * x_scale * clip[0] + by_y * y_scale * clip[1]) * inverse);
    }
}

/// Adds the change that a crossing makes to a copy of the image [N, H, W, C]. Crossings must be
/// blended in the order of their pixels, by one thread.
inline void blend_crossing(const Crossing& crossing, const float* image, std::int64_t channels,
                           float* blended) {
    const Blend blend = blend_of(crossing);
    const float* own = image + blend.pixel * channels;
    const float* other = image + blend.other * channels;
    for (std::int64_t c = 0; c < channels; ++c)
        blended[blend.pixel * channels + c] += blend.weight * (other[c] - own[c]);
}

/// Moves a crossing's share of image_gradient, a copy of `gradient` [N, H, W, C], between its
/// pixels, and adds the gradient with respect to the edge's ends if `clip_gradient` is given.
inline void blend_crossing_backward(const AntialiasParameters& p, const Crossing& crossing,
                                    const float* image, const float* gradient,
                                    std::int64_t channels, float* image_gradient,
                                    const Accumulator& clip_gradient) {
    const Blend blend = blend_of(crossing);
    float by_distance = 0;
    for (std::int64_t c = 0; c < channels; ++c) {
        const float g = gradient[blend.pixel * channels + c];
        image_gradient[blend.pixel * channels + c] -= blend.weight * g;
        image_gradient[blend.other * channels + c] += blend.weight * g;
        by_distance += g * (image[crossing.foreground * channels + c] -
                            image[crossing.background * channels + c]);
    }
    if (clip_gradient.wanted()) crossing_backward(p, crossing, by_distance, clip_gradient);
}

/// Parameters of the gathering version, in which each thread owns a pixel.
struct BlendParameters {
    AntialiasParameters raster;
    const float* image;         ///< [N, H, W, C]
    std::int64_t channels;      ///< C
    float* blended;             ///< [N, H, W, C]
    const float* gradient;      ///< [N, H, W, C] with respect to `blended`
    float* image_gradient;      ///< [N, H, W, C]
    Accumulator clip_gradient;  ///< [N, V, 4]
};

/// Calls f(crossing, own) for the crossings of a pixel, in the order of a list sorted by pixels.
/// own: true if the pair belongs to this pixel, false if it belongs to the left or upper neighbour.
template <typename F>
ITEM3D_HOST_DEVICE inline void for_each_crossing_at(const AntialiasParameters& p,
                                                    std::int64_t pixel, const F& f) {
    const std::int64_t x = pixel % p.width, y = pixel / p.width % p.height;
    Crossing crossing;
    if (y > 0 && find_crossing(p, pixel - p.width, true, crossing)) f(crossing, false);
    if (x > 0 && find_crossing(p, pixel - 1, false, crossing)) f(crossing, false);
    if (x + 1 < p.width && find_crossing(p, pixel, false, crossing)) f(crossing, true);
    if (y + 1 < p.height && find_crossing(p, pixel, true, crossing)) f(crossing, true);
}

ITEM3D_HOST_DEVICE inline void blend_pixel(const BlendParameters& p, std::int64_t pixel) {
    const std::int64_t channels = p.channels;
    const float* own = p.image + pixel * channels;
    float* out = p.blended + pixel * channels;
    for (std::int64_t c = 0; c < channels; ++c)
        out[c] = own[c];
    for_each_crossing_at(p.raster, pixel, [&](const Crossing& crossing, bool) {
        const Blend blend = blend_of(crossing);
        if (blend.pixel != pixel) return;
        const float* other = p.image + blend.other * channels;
        for (std::int64_t c = 0; c < channels; ++c)
            out[c] += blend.weight * (other[c] - own[c]);
    });
}

ITEM3D_HOST_DEVICE inline void blend_pixel_backward(const BlendParameters& p, std::int64_t pixel) {
    const std::int64_t channels = p.channels;
    float* out = p.image_gradient + pixel * channels;
    for (std::int64_t c = 0; c < channels; ++c)
        out[c] = p.gradient[pixel * channels + c];
    for_each_crossing_at(p.raster, pixel, [&](const Crossing& crossing, bool own) {
        const Blend blend = blend_of(crossing);
        const float* gradient = p.gradient + blend.pixel * channels;
        for (std::int64_t c = 0; c < channels; ++c)
            out[c] += (blend.pixel == pixel ? -blend.weight : blend.weight) * gradient[c];
        if (!own || !p.clip_gradient.wanted()) return;
        float by_distance = 0;
        for (std::int64_t c = 0; c < channels; ++c)
            by_distance += gradient[c] * (p.image[crossing.foreground * channels + c] -
                                          p.image[crossing.background * channels + c]);
        crossing_backward(p.raster, crossing, by_distance, p.clip_gradient);
    });
}

}  // namespace item3d::kernels
