// Sums of max(0, n.l) over cube maps.
//
// max(0, c) = (c + |c|) / 2, so that with flux f(l) = radiance times solid angle
//
//     sum_l max(0, n.l) f(l) = (n . sum_l l f(l) + sum_l |n.l| f(l)) / 2
//
// The first sum is one vector (moment) for each channel. The second sum does not change when l or n
// changes its sign. Texels are therefore added to those of the opposite direction (folded). Half of
// the texels and half of the outputs then suffice: the faces 0, 2 and 4.
//
//     antipode of (face, row, column): the opposite face,
//     +X <-> -X, +Z <-> -Z:  (size - 1 - row, column)        +Y <-> -Y:  (row, size - 1 - column)
//
// Texels with a large share of the light are summed one by one at full resolution, because |n.l|
// has a kink at the horizon that the coarse sum would smooth.
//
//     map      planes of cube_planes.h        moments   [6 S rows, 3 colours, 3]
//     texels   [64] indices, -1: none         partial   [runs, 64, 3]
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/render/kernels/cube_planes.h"

#include <cstdint>

namespace item3d::kernels {

/// Edge of an irradiance map in texels. Bilinear lookups in a coarser map show artefacts where a
/// sun sets (docs/renderer.md).
inline constexpr int irradiance_size = 128;

/// Row and column of a texel's antipode on the opposite face.
struct Antipode {
    int row, column;
};
ITEM3D_HOST_DEVICE inline Antipode antipode(int face, int row, int column, int size) {
    const bool sides = face / 2 != 1;
    return {sides ? size - 1 - row : row, sides ? column : size - 1 - column};
}

struct FoldParameters {
    ConstPlanes map;
    Planes sums;
    int length;
};

/// Sets out = map(d) + map(-d). index: number of a run, counted over the planes.
ITEM3D_HOST_DEVICE inline void fold(const FoldParameters& p, std::int64_t index) {
    const Run run = run_of(index, p.map.size, p.length);
    const int face = run.plane < 18 ? run.plane / 3 : 0;
    const int opposite = run.plane < 18 ? 3 * (face ^ 1) + run.plane % 3 : run.plane;
    for (int x = run.begin; x < run.end; ++x) {
        const Antipode other = antipode(face, run.row, x, p.map.size);
        p.sums.row(run.plane, run.row)[x] =
            p.map.row(run.plane, run.row)[x] + p.map.row(opposite, other.row)[other.column];
    }
}

struct MomentParameters {
    ConstPlanes map;
    float* moments;  ///< [6 * S, 3 channels, 3], by rows of all faces
};

/// Sums value times direction over a row. index: number of a row, counted over the six faces.
ITEM3D_HOST_DEVICE inline void row_moments(const MomentParameters& p, std::int64_t index) {
    const int face = static_cast<int>(index / p.map.size);
    const int row = static_cast<int>(index % p.map.size);
    Vec3 sums[3] = {Vec3(0.0f), Vec3(0.0f), Vec3(0.0f)};
    for (int x = 0; x < p.map.size; ++x) {
        const Vec3 d = unit_direction(face, row, x, p.map.size);
        for (int c = 0; c < 3; ++c)
            sums[c] += p.map.row(3 * face + c, row)[x] * d;
    }
    for (int c = 0; c < 3; ++c)
        for (int axis = 0; axis < 3; ++axis)
            p.moments[(index * 3 + c) * 3 + axis] = sums[c][axis];
}

struct CosineParameters {
    ConstPlanes even;      ///< sums of |n.l| for the faces 0, 2 and 4, and optionally a tenth plane
    const float* moments;  ///< [3 channels, 3]
    Planes out;
    int length;
};

/// Adds both sums and halves the result. index: number of a run, counted over the six faces and the
/// shared plane.
ITEM3D_HOST_DEVICE inline void join_cosine(const CosineParameters& p, std::int64_t index) {
    const Run run = run_of(index, p.out.size, p.length);
    const int face = run.plane;
    for (int x = run.begin; x < run.end; ++x) {
        if (face == 6) {
            p.out.row(18, run.row)[x] = 0.5f * p.even.row(9, run.row)[x];
            continue;
        }
        const Vec3 n = unit_direction(face, run.row, x, p.out.size);
        const Antipode other =
            face % 2 == 0 ? Antipode{run.row, x} : antipode(face, run.row, x, p.out.size);
        for (int c = 0; c < 3; ++c) {
            const float* moment = p.moments + 3 * c;
            const float odd = moment[0] * n.x + moment[1] * n.y + moment[2] * n.z;
            const float even = p.even.row(3 * (face / 2) + c, other.row)[other.column];
            p.out.row(3 * face + c, run.row)[x] = 0.5f * (odd + even);
        }
    }
}

/// Parameters of the texels whose part of the irradiance is summed exactly.
struct BrightParameters {
    const std::int64_t* texels;  ///< [count] indices into [6, S, S]; -1 for an unused entry
    int count, size;             ///< size: S
    ConstPlanes flux;            ///< S x S texels
    ConstPlanes gradient;        ///< gradient with respect to the irradiance's sums
    Planes out;                  ///< planes to add to, or to set
    const float* values;         ///< [count, 3] new values; zeros if null
    float* partial_sums;         ///< [runs, count, 3]
};

ITEM3D_HOST_DEVICE inline FaceTexel place_of(std::int64_t index, int size) {
    const std::int64_t faces = static_cast<std::int64_t>(size) * size, in_face = index % faces;
    return {static_cast<int>(index / faces), static_cast<int>(in_face / size),
            static_cast<int>(in_face % size)};
}

/// Number of normals for each device thread. With fewer normals, there would be more partial sums
/// to add.
inline constexpr int device_bright_run = 32;

/// Values of max(0, n.l) for a run of the irradiance map's normals.
template <int Length>
struct RunCosines {
    float x[Length], y[Length], z[Length], cosine[Length];

    ITEM3D_HOST_DEVICE explicit RunCosines(const Run& run) {
        for (int i = 0; i < Length; ++i) {
            const Vec3 n = unit_direction(run.plane, run.row, run.begin + i, irradiance_size);
            x[i] = n.x;
            y[i] = n.y;
            z[i] = n.z;
        }
    }
    ITEM3D_HOST_DEVICE void look(const FaceTexel& at, int size) {
        const Vec3 d = unit_direction(at.face, at.row, at.column, size);
        for (int i = 0; i < Length; ++i) {
            const float dot = x[i] * d.x + y[i] * d.y + z[i] * d.z;
            cosine[i] = dot > 0 ? dot : 0.0f;
        }
    }
};

/// Adds the bright texels' irradiance to a run. index: number of the run, counted over the six
/// faces.
template <int Length>
ITEM3D_HOST_DEVICE inline void add_bright(const BrightParameters& p, std::int64_t index) {
    const Run run = run_of(index, irradiance_size, Length);
    RunCosines<Length> cosines(run);
    for (int k = 0; k < p.count; ++k) {
        if (p.texels[k] < 0) continue;
        const FaceTexel at = place_of(p.texels[k], p.size);
        cosines.look(at, p.size);
        for (int c = 0; c < 3; ++c) {
            const float flux = p.flux.row(3 * at.face + c, at.row)[at.column];
            float* out = p.out.row(3 * run.plane + c, run.row) + run.begin;
            for (int i = 0; i < Length; ++i)
                out[i] += cosines.cosine[i] * flux;
        }
    }
}

/// Sums the transpose of add_bright() over a run. index: as in add_bright().
template <int Length>
ITEM3D_HOST_DEVICE inline void sum_bright(const BrightParameters& p, std::int64_t index) {
    constexpr int lanes = Length < 8 ? Length : 8;
    const Run run = run_of(index, irradiance_size, Length);
    RunCosines<Length> cosines(run);
    for (int k = 0; k < p.count; ++k) {
        float* sums = p.partial_sums + (index * p.count + k) * 3;
        for (int c = 0; c < 3; ++c)
            sums[c] = 0;
        if (p.texels[k] < 0) continue;
        cosines.look(place_of(p.texels[k], p.size), p.size);
        for (int c = 0; c < 3; ++c) {
            const float* in = p.gradient.row(3 * run.plane + c, run.row) + run.begin;
            float parts[lanes] = {};
            for (int i = 0; i < Length; i += lanes)
                for (int lane = 0; lane < lanes; ++lane)
                    parts[lane] += cosines.cosine[i + lane] * in[i + lane];
            for (const float part : parts)
                sums[c] += part;
        }
    }
}

/// Sets the three colours of bright texel `index`.
ITEM3D_HOST_DEVICE inline void set_bright(const BrightParameters& p, std::int64_t index) {
    if (p.texels[index] < 0) return;
    const FaceTexel at = place_of(p.texels[index], p.size);
    for (int c = 0; c < 3; ++c)
        p.out.row(3 * at.face + c, at.row)[at.column] =
            p.values != nullptr ? p.values[3 * index + c] : 0.0f;
}

}  // namespace item3d::kernels
