// Cube maps as planes with halos, for stencils and sums along rows.
//
//     +-+--------+-+       row_step = size + 16
//     |0|  above |0|       halo of 8 texels on each side: the neighbouring faces' texels,
//     +-+--------+-+       unfolded over the edges; beyond corners 2 x 2 means, else 0
//     |l|  face  |r|
//     |e|size^2  |i|       plane 3 face + colour, plane 18: shared by all faces
//     |f|        |g|       plane_step = row_step^2 + 80
//     +-+--------+-+
//     |0|  below |0|
//     +-+--------+-+
//
// Upsampling puts a parabola through three texels a, b and c at -1, 0 and 1. It evaluates the
// parabola a quarter of a texel off the middle, along rows and along columns:
//
//     f(x) = a x (x - 1) / 2 + b (1 - x^2) + c x (x + 1) / 2      f(1/4) = (-3 a + 30 b + 5 c) / 32
//
// Restriction is its transpose: a coarse texel is the sum of six fine texels in a row, times -3, 5,
// 30, 30, 5 and -3 over 32. Restriction keeps the sum and the mean position of a light, because the
// three weights of a fine texel add up to 1, and their mean position is that of the texel.
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/core/math.h"
#include "item3d/render/kernels/cube.h"

#include <cstdint>

namespace item3d::kernels {

/// Three colours of six faces, [6, 3, S, S], and optionally a 19th plane. All faces share this
/// plane, which holds a quantity that is the same on each face, in any orientation. Around each
/// plane is a halo of the neighbouring faces' texels, unfolded over the edges. Beyond the corners
/// the halo has 2 x 2 means, and otherwise 0.
template <typename Float>
struct BasicPlanes {
    /// Width of the halo in texels. It covers the reach of near sums, which is three texels at a
    /// face's centre. At a corner, a texel appears three times smaller outwards and sqrt(3) times
    /// smaller across, so that the reach is at most 7.4 texels of a row or column.
    static constexpr int halo = 8;

    Float* values;  ///< texel (0, 0) of plane 0
    int size, count;

    /// Returns the number of floats between rows.
    ITEM3D_HOST_DEVICE std::int64_t row_step() const { return size + 2 * halo; }
    /// Returns the number of floats between planes. It is not a multiple of a page: such a step
    /// would map all planes to the same lines of a processor's cache.
    ITEM3D_HOST_DEVICE std::int64_t plane_step() const { return row_step() * row_step() + 80; }
    ITEM3D_HOST_DEVICE Float* row(int plane, int y) const {
        return values + plane * plane_step() + y * row_step();
    }
};
using Planes = BasicPlanes<float>;
using ConstPlanes = BasicPlanes<const float>;

/// Run of adjacent texels of a row, which one index of a kernel processes. A run has many texels on
/// a CPU, and few on a device.
struct Run {
    int plane, row, begin, end;
};
/// Returns run `index`, counted over the rows of all planes. length: number of texels in a run,
/// which divides `size`.
ITEM3D_HOST_DEVICE inline Run run_of(std::int64_t index, int size, int length) {
    const std::int64_t runs = size / length, rows = index / runs;
    const int begin = static_cast<int>(index % runs) * length;
    return {static_cast<int>(rows / size), static_cast<int>(rows % size), begin, begin + length};
}

ITEM3D_HOST_DEVICE inline Vec3 unit_direction(int face, int row, int column, int size) {
    return glm::normalize(
        cube_direction(face, texel_centre(column, size), texel_centre(row, size)));
}

/// Returns the direction, not of unit length, of a texel beyond a face's edge. side: 0 left, 1
/// right, 2 above, 3 below; along: position along the edge; beyond: distance from the edge in
/// texels, 1, 2, ...
ITEM3D_HOST_DEVICE inline Vec3 halo_direction(int face, int side, int along, int beyond, int size) {
    const CubeFrame frame = cube_frame(face);
    const Vec3 over = side < 2 ? frame.s : frame.t, edge = side < 2 ? frame.t : frame.s;
    return (side % 2 == 1 ? over : -over) + texel_centre(along, size) * edge -
           texel_centre(beyond - 1, size) * frame.normal;
}

/// Face, row and column of a texel.
struct FaceTexel {
    int face, row, column;
};
ITEM3D_HOST_DEVICE inline FaceTexel face_texel(Vec3 d, int size) {
    const int face = cube_face(d);
    const FaceCoordinates at = face_coordinates(face, d);
    return {face, static_cast<int>((at.t / at.major + 1) * 0.5f * size),
            static_cast<int>((at.s / at.major + 1) * 0.5f * size)};
}

struct HaloParameters {
    Planes planes;
    int depth;  ///< filled texels of the halo
    int length;
};

/// Copies the neighbours' texels beyond an edge. index: number of a run along the edge, counted
/// over the rows of the halo, the sides and the planes.
ITEM3D_HOST_DEVICE inline void fill_halo_side(const HaloParameters& p, std::int64_t index) {
    const int size = p.planes.size;
    const std::int64_t runs = size / p.length, strip = index / runs;
    const int begin = static_cast<int>(index % runs) * p.length;
    const int k = static_cast<int>(strip % p.depth), side = static_cast<int>(strip / p.depth % 4);
    const int plane = static_cast<int>(strip / p.depth / 4), face = plane < 18 ? plane / 3 : 0;
    const FaceTexel first = face_texel(halo_direction(face, side, begin, k + 1, size), size);
    const FaceTexel next = face_texel(halo_direction(face, side, begin ^ 1, k + 1, size), size);
    const std::int64_t row = p.planes.row_step();
    const std::int64_t step =
        ((next.row - first.row) * row + next.column - first.column) * ((begin & 1) != 0 ? -1 : 1);
    const float* in =
        p.planes.row(plane < 18 ? 3 * first.face + plane % 3 : plane, first.row) + first.column;
    const int beyond = side % 2 == 1 ? size + k : -1 - k;
    float* out =
        side < 2 ? p.planes.row(plane, begin) + beyond : p.planes.row(plane, beyond) + begin;
    const std::int64_t out_step = side < 2 ? row : 1;
    for (int i = 0; i < p.length; ++i)
        out[i * out_step] = in[i * step];
}

/// Fills the halo diagonally beyond a corner. The sides must be filled before. Two by two texels
/// become means over the three faces that meet there, and all others become 0, so that restriction
/// is the transpose of upsampling at corners too. index: number of a corner, counted over the
/// planes.
ITEM3D_HOST_DEVICE inline void fill_halo_corner(const HaloParameters& p, std::int64_t index) {
    const int plane = static_cast<int>(index / 4), right = static_cast<int>(index % 2),
              below = static_cast<int>(index / 2 % 2), last = p.planes.size - 1;
    const std::int64_t row = p.planes.row_step();
    // (i, j) counts texels from the corner outwards. A texel becomes the mean of its mirror images,
    // one in the face and one in each adjacent side of the halo.
    const std::int64_t over = right != 0 ? 1 : -1, under = below != 0 ? row : -row;
    float* at = p.planes.row(plane, below != 0 ? last : 0) + (right != 0 ? last : 0);
    for (int j = 0; j < p.depth; ++j)
        for (int i = 0; i < p.depth; ++i) {
            const std::int64_t x = (1 + i) * over, y = (1 + j) * under;
            at[x + y] = i < 2 && j < 2
                            ? (at[-i * over - j * under] + at[x - j * under] + at[y - i * over]) / 3
                            : 0.0f;
        }
}

/// Weights of upsampling. They evaluate the parabola through a texel and its two neighbours, a
/// quarter of a texel off the texel's middle.
inline constexpr float weight_toward = 5.0f / 32, weight_middle = 30.0f / 32,
                       weight_away = -3.0f / 32;

/// Upsamples Length texels, from (row, column) on, to twice the resolution. coarse: texel (0, 0) of
/// a map with a halo of at least one texel.
template <int Length>
ITEM3D_HOST_DEVICE ITEM3D_ALWAYS_INLINE inline void upsample_run(const float* coarse,
                                                                 std::int64_t coarse_row, int row,
                                                                 int column, float* out) {
    constexpr int half = Length / 2;
    const float* centre = coarse + (row / 2) * coarse_row + column / 2 - 1;
    const float* near = centre + (row % 2 == 1 ? coarse_row : -coarse_row);
    const float* far = centre - (row % 2 == 1 ? coarse_row : -coarse_row);
    float blend[half + 4];
    for (int i = 0; i < half + 4; ++i)
        blend[i] = weight_middle * centre[i] + weight_toward * near[i] + weight_away * far[i];
    for (int i = 0; i < half; ++i) {
        out[2 * i] =
            weight_toward * blend[i] + weight_middle * blend[i + 1] + weight_away * blend[i + 2];
        out[2 * i + 1] =
            weight_away * blend[i] + weight_middle * blend[i + 1] + weight_toward * blend[i + 2];
    }
}

/// Number of fine texels for each device thread. It is the smallest possible number, which makes
/// the most threads.
inline constexpr int device_resized_run = 2;

/// Parameters of resizing between a map and one of half its size.
struct ResizeParameters {
    ConstPlanes from;
    Planes to;
    bool add;  ///< upsampling only: add to the present values
};

/// Upsamples a run. index: number of a run of the finer map's texels.
template <int Length>
ITEM3D_HOST_DEVICE inline void upsample(const ResizeParameters& p, std::int64_t index) {
    const Run run = run_of(index, p.to.size, Length);
    float fine[Length];
    upsample_run<Length>(p.from.row(run.plane, 0), p.from.row_step(), run.row, run.begin, fine);
    float* out = p.to.row(run.plane, run.row) + run.begin;
    for (int i = 0; i < Length; ++i)
        out[i] = p.add ? out[i] + fine[i] : fine[i];
}

/// Transpose of upsampling. p.from must have a halo of at least two texels. index: number of a run
/// of Length / 2 texels of the coarser map.
template <int Length>
ITEM3D_HOST_DEVICE inline void restrict_run(const ResizeParameters& p, std::int64_t index) {
    const Run run = run_of(index, p.to.size, Length / 2);
    const float* in = p.from.row(run.plane, 2 * run.row - 2) + 2 * run.begin - 2;
    const std::int64_t row = p.from.row_step();
    float blend[Length + 4];
    for (int x = 0; x < Length + 4; ++x)
        blend[x] = weight_away * (in[x] + in[x + 5 * row]) +
                   weight_toward * (in[x + row] + in[x + 4 * row]) +
                   weight_middle * (in[x + 2 * row] + in[x + 3 * row]);
    float* out = p.to.row(run.plane, run.row) + run.begin;
    for (int x = 0; x < Length / 2; ++x) {
        const float* six = blend + 2 * x;
        out[x] = weight_away * (six[0] + six[5]) + weight_toward * (six[1] + six[4]) +
                 weight_middle * (six[2] + six[3]);
    }
}

/// Parameters of the conversion from [6, S, S, 3], with any strides, to planes.
struct MapToPlanesParameters {
    const float* map;
    std::int64_t step[4];
    const float* weight;  ///< [S, S], the same for each face
    Planes planes;
    int length;
};

/// Sets planes = map * weight, and the shared plane, if present, to the weights. index: number of a
/// run, counted over the six faces and the shared plane.
ITEM3D_HOST_DEVICE inline void map_to_planes(const MapToPlanesParameters& p, std::int64_t index) {
    const Run run = run_of(index, p.planes.size, p.length);
    const float* weight = p.weight + static_cast<std::int64_t>(run.row) * p.planes.size;
    if (run.plane == 6) {
        float* out = p.planes.row(18, run.row);
        for (int x = run.begin; x < run.end; ++x)
            out[x] = weight[x];
        return;
    }
    const float* in = p.map + run.plane * p.step[0] + run.row * p.step[1];
    for (int c = 0; c < 3; ++c) {
        float* out = p.planes.row(3 * run.plane + c, run.row);
        for (int x = run.begin; x < run.end; ++x)
            out[x] = in[x * p.step[2] + c * p.step[3]] * weight[x];
    }
}

struct PlanesToMapParameters {
    ConstPlanes planes;
    const float* weight;  ///< [S, S]
    float* map;           ///< [6, S, S, 3]
    int length;
};

/// Sets map = planes * weight. index: number of a run, counted over the six faces.
ITEM3D_HOST_DEVICE inline void planes_to_map(const PlanesToMapParameters& p, std::int64_t index) {
    const Run run = run_of(index, p.planes.size, p.length);
    const std::int64_t size = p.planes.size;
    const float* weight = p.weight + run.row * size;
    float* out = p.map + 3 * (run.plane * size + run.row) * size;
    for (int c = 0; c < 3; ++c) {
        const float* in = p.planes.row(3 * run.plane + c, run.row);
        for (int x = run.begin; x < run.end; ++x)
            out[3 * x + c] = in[x] * weight[x];
    }
}

/// Parameters of planes_to_means(), which computes means of radiance.
struct MeansParameters {
    float* map;             ///< [6, S, S, 3]
    float* inverse_weight;  ///< [S, S]
    ConstPlanes sums;       ///< the shared plane has the sums of solid angle
    int length;
};

/// Divides the sums of radiance by those of solid angle. sums: first texel of the run in plane 0.
ITEM3D_HOST_DEVICE ITEM3D_ALWAYS_INLINE inline void store_means(const MeansParameters& p,
                                                                const Run& run, const float* sums,
                                                                std::int64_t plane_step) {
    const int count = run.end - run.begin;
    const std::int64_t size = p.sums.size;
    float* inverse = p.inverse_weight + run.row * size + run.begin;
    for (int x = 0; x < count; ++x) {
        const float angle = sums[18 * plane_step + x];
        inverse[x] = 1 / (angle > 1e-30f ? angle : 1e-30f);
    }
    for (int face = 0; face < 6; ++face) {
        float* out = p.map + 3 * ((face * size + run.row) * size + run.begin);
        const float* in = sums + 3 * face * plane_step;
        for (int x = 0; x < count; ++x)
            for (int c = 0; c < 3; ++c)
                out[3 * x + c] = in[c * plane_step + x] * inverse[x];
    }
}

/// Sets the means of a run on all six faces. index: number of the run on a face.
ITEM3D_HOST_DEVICE inline void planes_to_means(const MeansParameters& p, std::int64_t index) {
    const Run run = run_of(index, p.sums.size, p.length);
    store_means(p, run, p.sums.row(0, run.row) + run.begin, p.sums.plane_step());
}

}  // namespace item3d::kernels
