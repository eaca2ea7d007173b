// Projection of world-space vertices to clip space, p_clip = M (x, y, z, 1). The product is written
// out instead of using a library, because vertices at equal positions must be equal bit for bit.
// Otherwise seams of the UV map would show cracks.
//
//     world_to_clip  [N, 4, 4], column-major: m[4 column + row]
//     positions      [V, 3]        positions_clip  [N, V, 4]
#pragma once

#include "item3d/core/host_device.h"

#include <cstdint>

namespace item3d::kernels {

struct ProjectParameters {
    const float* positions;      ///< [V, 3] world space
    const float* world_to_clip;  ///< [N, 4, 4] column-major
    float* positions_clip;       ///< [N, V, 4]
    std::int64_t vertices;       ///< V
};

/// Projects one vertex. index: view * V + vertex.
ITEM3D_HOST_DEVICE inline void project_vertex(const ProjectParameters& p, std::int64_t index) {
    const float* m = p.world_to_clip + 16 * (index / p.vertices);
    const float* x = p.positions + 3 * (index % p.vertices);
    float* out = p.positions_clip + 4 * index;
    for (int row = 0; row < 4; ++row)
        out[row] = m[row] * x[0] + m[4 + row] * x[1] + m[8 + row] * x[2] + m[12 + row];
}

}  // namespace item3d::kernels
