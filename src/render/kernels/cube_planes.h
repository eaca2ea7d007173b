// Cube maps as planes with halos: for stencils and sums that run along rows.
#pragma once

#include "item3d/core/math.h"
#include "item3d/core/parallel.h"
#include "item3d/render/kernels/cube.h"

#include <algorithm>
#include <cstdint>
#include <memory>

namespace item3d::kernels {

/// N floats at once. Written as a vector where the compiler does not make one by itself.
template <int N>
struct Vector {
    typedef float Type __attribute__((vector_size(4 * N)));  // GCC 12 loses it in a `using`
};
template <int N>
using Lanes = typename Vector<N>::Type;

template <int N>
[[gnu::always_inline]] inline Lanes<N> load_lanes(const float* values) {
    Lanes<N> lanes;
    __builtin_memcpy(&lanes, values, sizeof lanes);
    return lanes;
}
template <int N>
[[gnu::always_inline]] inline void store_lanes(float* values, const Lanes<N>& lanes) {
    __builtin_memcpy(values, &lanes, sizeof lanes);
}

/// Three colours of six faces, [6, 3, S, S], and perhaps a 19th plane: a quantity that is the same
/// on all faces, however they are turned. Around each plane lies a halo of the neighbouring faces'
/// texels, unfolded over its edges; beyond its corners there is nothing (0).
class CubePlanes {
  public:
    static constexpr int halo = 8;

    CubePlanes(int size, bool shared_plane)
        : size_(size),
          count_(shared_plane ? 19 : 18),
          values_(std::make_unique_for_overwrite<float[]>(
              static_cast<std::size_t>(count_ * plane_step()))) {}

    int size() const { return size_; }
    int count() const { return count_; }
    bool shared_plane() const { return count_ == 19; }
    /// Floats from a row to the next.
    std::int64_t row_step() const { return size_ + 2 * halo; }
    /// Floats from a plane to the next; not a multiple of a page, for which all would compete for
    /// the same lines of the cache.
    std::int64_t plane_step() const { return row_step() * row_step() + 80; }
    float* plane(int index) { return values_.get() + offset(index); }
    const float* plane(int index) const { return values_.get() + offset(index); }
    float* row(int plane_, int y) { return plane(plane_) + y * row_step(); }
    const float* row(int plane_, int y) const { return plane(plane_) + y * row_step(); }
    void clear() { std::fill_n(values_.get(), count_ * plane_step(), 0.0f); }

  private:
    /// Of texel (0, 0).
    std::int64_t offset(int index) const { return index * plane_step() + halo * (row_step() + 1); }

    int size_, count_;
    std::unique_ptr<float[]> values_;
};

/// Direction of a texel beyond a face's edge, not unit. side: left, right, above, below; along:
/// texels along the edge; beyond: 1, 2, ..
inline Vec3 halo_direction(int face, int side, int along, int beyond, int size) {
    const CubeFrame frame = cube_frame(face);
    const Vec3 over = side < 2 ? frame.s : frame.t, edge = side < 2 ? frame.t : frame.s;
    return (side % 2 == 1 ? over : -over) + texel_centre(along, size) * edge -
           texel_centre(beyond - 1, size) * frame.normal;
}

/// A texel's index in a row-major face.
struct FaceTexel {
    int face, row, column;
};
inline FaceTexel face_texel(Vec3 d, int size) {
    const int face = cube_face(d);
    const FaceCoordinates at = face_coordinates(face, d);
    const auto index = [&](float x) { return static_cast<int>((x / at.major + 1) * 0.5f * size); };
    return {face, index(at.t), index(at.s)};
}

/// Copies the neighbours' texels into the halo, `depth` deep. The two by two texels diagonally off
/// a corner become means over the three faces that meet there; that, and 0 beyond, makes
/// restricted() the transpose of upsampling at corners too.
inline void fill_halo(CubePlanes& planes, int depth) {
    const int size = planes.size();
    const std::int64_t row = planes.row_step();
    parallel_for(
        "fill_halo", planes.count(),
        [&](std::int64_t index) {
            const int plane = static_cast<int>(index), face = plane < 18 ? plane / 3 : 0;
            float* out = planes.plane(plane);
            for (int side = 0; side < 4; ++side) {
                const auto place = [&](int along, int beyond) {
                    return face_texel(halo_direction(face, side, along, beyond, size), size);
                };
                const FaceTexel first = place(0, 1), along = place(1, 1), beyond = place(0, 2);
                const auto step = [&](const FaceTexel& to) {
                    return (to.row - first.row) * row + to.column - first.column;
                };
                const float* in = planes.plane(plane < 18 ? 3 * first.face + plane % 3 : plane) +
                                  first.row * row + first.column;
                const std::int64_t source_along = step(along), source_beyond = step(beyond);
                const std::int64_t target_along = side < 2 ? row : 1;
                const std::int64_t target_beyond = (side < 2 ? 1 : row) * (side % 2 == 1 ? 1 : -1);
                float* target =
                    out + (side % 2 == 1 ? size - 1 : 0) * (side < 2 ? 1 : row) + target_beyond;
                for (int k = 0; k < depth; ++k)
                    for (int i = 0; i < size; ++i)
                        target[k * target_beyond + i * target_along] =
                            in[k * source_beyond + i * source_along];
            }
            for (int corner = 0; corner < 4; ++corner) {
                const int right = corner & 1, below = corner >> 1;
                // From the corner on, outwards: across its edges mirrored, then over both.
                const std::int64_t over = right ? 1 : -1, under = below ? row : -row;
                float* at = out + (below ? size - 1 : 0) * row + (right ? size - 1 : 0);
                for (int j = 0; j < depth; ++j)
                    for (int i = 0; i < depth; ++i) {
                        const std::int64_t x = (1 + i) * over, y = (1 + j) * under;
                        at[x + y] = i < 2 && j < 2 ? (at[-i * over - j * under] +
                                                      at[x - j * under] + at[y - i * over]) /
                                                         3
                                                   : 0.0f;
                    }
            }
        },
        1);
}

/// Texels of a row that are worked on together.
inline constexpr int row_tile = 32;

/// Going from a resolution to the next finer one: the parabola through a texel and its two
/// neighbours, in both directions, a quarter of a texel off its middle.
inline constexpr float toward = 5.0f / 32, middle = 30.0f / 32, away = -3.0f / 32;

/// Twice as fine a plane: row_tile texels from (row, column) on. coarse: texel (0, 0), its halo at
/// least one texel deep.
[[gnu::always_inline]] inline void upsample_row(const float* coarse, std::int64_t coarse_row,
                                                int row, int column, float* out) {
    constexpr int half = row_tile / 2;
    const float* centre = coarse + (row / 2) * coarse_row + column / 2 - 1;
    const float* near = centre + (row % 2 == 1 ? coarse_row : -coarse_row);
    const float* far = centre - (row % 2 == 1 ? coarse_row : -coarse_row);
    float blend[half + 4];
    for (int i = 0; i < half + 4; ++i)
        blend[i] = middle * centre[i] + toward * near[i] + away * far[i];
    for (int i = 0; i < half; ++i) {
        out[2 * i] = toward * blend[i] + middle * blend[i + 1] + away * blend[i + 2];
        out[2 * i + 1] = away * blend[i] + middle * blend[i + 1] + toward * blend[i + 2];
    }
}

/// The transpose of upsampling, with a full halo. fine: its halo at least two texels deep.
inline CubePlanes restricted(const CubePlanes& fine) {
    const int half = fine.size() / 2;
    CubePlanes coarse(half, fine.shared_plane());
    parallel_for(
        "restrict_cube", static_cast<std::int64_t>(fine.count()) * half,
        [&](std::int64_t i) {
            const int plane = static_cast<int>(i / half), y = static_cast<int>(i % half);
            const float* in = fine.row(plane, 2 * y - 2);
            const std::int64_t row = fine.row_step();
            const auto six = [](const float* at, std::int64_t step) {
                return away * (at[0] + at[5 * step]) + toward * (at[step] + at[4 * step]) +
                       middle * (at[2 * step] + at[3 * step]);
            };
            float* out = coarse.row(plane, y);
            for (int begin = 0; begin < 2 * half; begin += row_tile) {
                float blend[row_tile + 4];
                for (int x = 0; x < row_tile + 4; ++x)
                    blend[x] = six(in + begin + x - 2, row);
                for (int x = 0; x < row_tile / 2; ++x)
                    out[begin / 2 + x] = six(blend + 2 * x, 1);
            }
        },
        16);
    fill_halo(coarse, CubePlanes::halo);
    return coarse;
}

/// Adds the planes of a map of the same size.
inline void add(CubePlanes& to, const CubePlanes& map) {
    const int size = to.size();
    for (int plane = 0; plane < to.count(); ++plane)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                to.row(plane, y)[x] += map.row(plane, y)[x];
}

/// Calls f(plane, row, column, values) for row_tile texels after another of the map, twice as fine.
template <typename F>
void for_each_upsampled(const CubePlanes& coarse, const F& f) {
    const int size = 2 * coarse.size();
    parallel_for(
        "upsample_cube", static_cast<std::int64_t>(coarse.count()) * size,
        [&](std::int64_t i) {
            const int plane = static_cast<int>(i / size), row = static_cast<int>(i % size);
            for (int column = 0; column < size; column += row_tile) {
                float fine[row_tile];
                upsample_row(coarse.plane(plane), coarse.row_step(), row, column, fine);
                f(plane, row, column, fine);
            }
        },
        16);
}

/// Adds a map of half the size; its halo at least one texel deep.
inline void add_upsampled(CubePlanes& to, const CubePlanes& coarse) {
    for_each_upsampled(coarse, [&](int plane, int row, int column, const float* fine) {
        float* out = to.row(plane, row) + column;
        for (int k = 0; k < row_tile; ++k)
            out[k] += fine[k];
    });
}

/// Twice as fine a map, without a halo. coarse: its halo at least one texel deep.
inline CubePlanes upsampled(const CubePlanes& coarse) {
    CubePlanes map(2 * coarse.size(), coarse.shared_plane());
    for_each_upsampled(coarse, [&](int plane, int row, int column, const float* fine) {
        std::copy_n(fine, row_tile, map.row(plane, row) + column);
    });
    return map;
}

}  // namespace item3d::kernels
