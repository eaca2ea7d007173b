// Barycentrics at a pixel's centre as functions of a triangle's clip-space vertices. This file has
// their slopes between pixels, and their gradients.
//
// A point of the triangle is p = b_0 p_0 + b_1 p_1 + b_2 p_2 in clip space (x, y, w), with vertices
// p_i and barycentrics b_i. It is seen at q = (x / w, y / w, 1) = p / w in normalized device
// coordinates. By Cramer's rule b_i is proportional to an edge function e_i:
//
//     e_i = q . n_i      n_0 = p_1 x p_2, n_1 = p_2 x p_0, n_2 = p_0 x p_1      b_i = e_i / s
//
// with s = e_0 + e_1 + e_2 (Olano and Greer 1997). Each e_i is linear in q, so
//
//     d b_i / d q_x = (n_i.x - b_i sum_j n_j.x) / s        q_x grows by 2 / width a pixel
//
// In the backward pass, let g_i be the gradient with respect to b_i. The gradient with respect to
// e_i is
//
//     G_i = (g_i - sum_j g_j b_j) / s
//
// Since q . (p_j x p_k) = p_j . (p_k x q) = p_k . (q x p_j), e_i adds G_i (p_k x q) to the gradient
// of p_j, and G_i (q x p_j) to that of p_k. Slopes also depend on n_i directly. Their gradient with
// respect to n_i is added to G_i q in these products.
//
//     clip  [V, 4] x y z w; z is not read        pixels: row 0 on top, q_y falls with rows
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/core/math.h"

#include <cstdint>

namespace item3d::kernels {

using DVec3 = glm::dvec3;

/// Vertices of a triangle as (x, y, w) of clip space.
struct ClipTriangle {
    DVec3 v[3];

    /// clip: [V, 4].
    ITEM3D_HOST_DEVICE ClipTriangle(const float* clip, const std::int32_t* corners) {
        for (int k = 0; k < 3; ++k) {
            const float* p = clip + 4 * static_cast<std::int64_t>(corners[k]);
            v[k] = DVec3(p[0], p[1], p[3]);
        }
    }
};

/// Returns the centre of pixel (x, y) in normalized device coordinates, with 1 as the third
/// component.
ITEM3D_HOST_DEVICE inline DVec3 pixel_centre(int x, int y, int width, int height) {
    return DVec3((x + 0.5) * 2.0 / width - 1.0, 1.0 - (y + 0.5) * 2.0 / height, 1.0);
}

/// Changes of (b_0, b_1) for one pixel to the right (by_x) and for one pixel down (by_y).
struct WeightSlopes {
    double by_x[2], by_y[2];
};

ITEM3D_HOST_DEVICE inline WeightSlopes weight_slopes(const ClipTriangle& triangle, DVec3 q,
                                                     const float* weights, int width, int height) {
    const DVec3* v = triangle.v;
    const DVec3 normal[3] = {glm::cross(v[1], v[2]), glm::cross(v[2], v[0]),
                             glm::cross(v[0], v[1])};
    const DVec3 total = normal[0] + normal[1] + normal[2];
    const double sum = glm::dot(q, total);
    WeightSlopes slopes{};
    if (sum == 0) return slopes;
    for (int k = 0; k < 2; ++k) {
        slopes.by_x[k] = (normal[k].x - weights[k] * total.x) / sum * 2.0 / width;
        slopes.by_y[k] = -(normal[k].y - weights[k] * total.y) / sum * 2.0 / height;
    }
    return slopes;
}

/// Sets the gradients with respect to the vertices' (x, y, w). weight_gradient: gradient with
/// respect to the weights. slope_gradient: gradient with respect to their slopes, or null. Returns
/// false, and sets no gradients, for a triangle without area on the screen.
ITEM3D_HOST_DEVICE inline bool weights_backward(const ClipTriangle& triangle, DVec3 q,
                                                const float* weights, const double* weight_gradient,
                                                const WeightSlopes* slope_gradient, int width,
                                                int height, DVec3* position_gradient) {
    const DVec3* v = triangle.v;
    const DVec3 normal[3] = {glm::cross(v[1], v[2]), glm::cross(v[2], v[0]),
                             glm::cross(v[0], v[1])};
    const DVec3 edges(glm::dot(q, normal[0]), glm::dot(q, normal[1]), glm::dot(q, normal[2]));
    const double sum = edges.x + edges.y + edges.z;
    if (sum == 0) return false;
    double by_weight[3] = {weight_gradient[0], weight_gradient[1], weight_gradient[2]};
    double by_slope_x[3] = {0, 0, 0}, by_slope_y[3] = {0, 0, 0};
    double slope_x_mean = 0, slope_y_mean = 0, by_sum = 0;
    if (slope_gradient != nullptr) {
        const DVec3 total = normal[0] + normal[1] + normal[2];
        for (int k = 0; k < 2; ++k) {
            by_slope_x[k] = slope_gradient->by_x[k] * 2.0 / width;
            by_slope_y[k] = -slope_gradient->by_y[k] * 2.0 / height;
            by_weight[k] -= (by_slope_x[k] * total.x + by_slope_y[k] * total.y) / sum;
            slope_x_mean += by_slope_x[k] * weights[k];
            slope_y_mean += by_slope_y[k] * weights[k];
            by_sum += (by_slope_x[k] * (normal[k].x - weights[k] * total.x) +
                       by_slope_y[k] * (normal[k].y - weights[k] * total.y)) /
                      sum;
        }
    }
    const double mean =
        by_weight[0] * weights[0] + by_weight[1] * weights[1] + by_weight[2] * weights[2] + by_sum;
    for (int k = 0; k < 3; ++k)
        position_gradient[k] = DVec3(0);
    for (int k = 0; k < 3; ++k) {
        const double edge_gradient = (by_weight[k] - mean) / sum;
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        if (slope_gradient == nullptr) {
            position_gradient[i] += edge_gradient * glm::cross(v[j], q);
            position_gradient[j] += edge_gradient * glm::cross(q, v[i]);
            continue;
        }
        const DVec3 by_normal = edge_gradient * q + DVec3((by_slope_x[k] - slope_x_mean) / sum,
                                                          (by_slope_y[k] - slope_y_mean) / sum, 0);
        position_gradient[i] += glm::cross(v[j], by_normal);
        position_gradient[j] += glm::cross(by_normal, v[i]);
    }
    return true;
}

}  // namespace item3d::kernels
