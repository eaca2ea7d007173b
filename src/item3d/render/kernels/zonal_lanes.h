// Zonal sums (zonal.h) of several adjacent texels at once, for a processor's vectors.
//
// Near sums: N adjacent texels of a row are N lanes. A tap (dy, dx) is one vector of weights,
// because each lane's texel is one further right. The weights serve six faces and three colours,
// which are 18 planes, or 19 with the shared plane. They also serve the row that is mirrored about
// the face's middle:
//
//     row         x x x x x x x x        up   = upper + dy row_step + dx
//     size-1-row  x x x x x x x x        down = lower - dy row_step + dx
//                 0 .. N - 1             sums [2 rows, planes, 32 texels]
//
// Far sums are computed for one output texel at a time. Lanes are adjacent source texels. Their
// weights are computed once for a batch of rows and used for all planes. The planes are turned, so
// that the output is on face 0:
//
//     weights  | row 0: groups of N | row 1: .. |        first [rows] index into a plane
//
// Each lane sums every N-th texel. The lanes are added at the end, in their order.
#pragma once

#include "item3d/render/kernels/zonal.h"

#include <algorithm>
#include <type_traits>

namespace item3d::kernels {

/// Vector of N floats. It is explicit, because the compiler does not always vectorise by itself.
template <int N>
struct Vector {
    typedef float Type __attribute__((vector_size(4 * N)));  // GCC 12 loses the attribute in a
                                                             // `using`
};
template <int N>
using Lanes = typename Vector<N>::Type;

template <int N>
ITEM3D_ALWAYS_INLINE inline Lanes<N> load_lanes(const float* values) {
    Lanes<N> lanes;
    __builtin_memcpy(&lanes, values, sizeof lanes);
    return lanes;
}
template <int N>
ITEM3D_ALWAYS_INLINE inline void store_lanes(float* values, const Lanes<N>& lanes) {
    __builtin_memcpy(values, &lanes, sizeof lanes);
}

/// Number of texels of a row that are processed together. It is the size of the smallest map with
/// near sums. More texels would share more of what they load, but would take more of the L1 cache.
/// The sums of two rows of 19 planes take 4.9 KB.
inline constexpr int row_tile = 32;

/// Returns 1 if any lane is below the limit, otherwise 0.
template <int N>
ITEM3D_ALWAYS_INLINE inline int any_below(const Lanes<N>& lanes, float limit) {
    const auto below = lanes < limit;
    std::int64_t pairs[N / 2];
    __builtin_memcpy(pairs, &below, sizeof pairs);
    std::int64_t any = 0;
    for (const std::int64_t pair : pairs)
        any |= pair;
    return any != 0;
}

/// Sums of two rows of all planes. The rows are mirror images of each other about a face's middle.
struct NearSums {
    float rows[2][max_planes][row_tile];
};

/// Taps within reach of N adjacent texels of a row, relative to the first of these texels.
template <int N>
struct NearTaps {
    static constexpr int halo = Planes::halo, maximum = (2 * halo + 1) * (2 * halo + 1);
    int count;
    Lanes<N> weight[maximum];
    /// Offset of a tap in a plane, and its offset for the mirrored row.
    std::int32_t place[maximum], mirrored[maximum];
};

template <int N>
ITEM3D_ALWAYS_INLINE inline void near_taps(const NearParameters& p, int row, int x,
                                           NearTaps<N>& taps) {
    const NearWindow window = near_window(p, row, x, N);
    // The kernel is copied, because otherwise possible aliasing keeps the compiler from
    // vectorising.
    const ZonalKernel kernel = p.kernel;
    const std::int64_t row_step = p.source.row_step();
    const float* centre = p.directions + row * row_step + x;
    const std::int64_t plane = p.direction_plane;
    const Lanes<N> n[3] = {load_lanes<N>(centre), load_lanes<N>(centre + plane),
                           load_lanes<N>(centre + 2 * plane)};
    int count = 0;
    for (int dy = window.rows.begin; dy < window.rows.end; ++dy) {
        for (int dx = window.columns.begin; dx < window.columns.end; ++dx) {
            const float* tap = centre + dy * row_step + dx;
            const Lanes<N> a = n[0] - load_lanes<N>(tap);
            const Lanes<N> b = n[1] - load_lanes<N>(tap + plane);
            const Lanes<N> c = n[2] - load_lanes<N>(tap + 2 * plane);
            const Lanes<N> d = a * a + b * b + c * c;
            taps.weight[count] = kernel.value(d);
            taps.place[count] = static_cast<std::int32_t>(dy * row_step + dx);
            taps.mirrored[count] = static_cast<std::int32_t>(-dy * row_step + dx);
            count += any_below<N>(d, kernel.outer);
        }
    }
    taps.count = count;
}

/// Adds the sums of Count planes at N texels of both rows. The lanes are adjacent texels, which
/// share the taps' offsets; all faces and both rows share the weights.
template <int N, int Count>
ITEM3D_ALWAYS_INLINE inline void add_near(const NearTaps<N>& taps, const float* upper,
                                          const float* lower, std::int64_t plane_step,
                                          float* upper_sums, float* lower_sums) {
    Lanes<N> above[Count], below[Count];
    for (int c = 0; c < Count; ++c) {
        above[c] = load_lanes<N>(upper_sums + c * row_tile);
        below[c] = load_lanes<N>(lower_sums + c * row_tile);
    }
    for (int i = 0; i < taps.count; ++i) {
        const Lanes<N> weight = taps.weight[i];
        const float *up = upper + taps.place[i], *down = lower + taps.mirrored[i];
#pragma GCC unroll 4
        for (int c = 0; c < Count; ++c) {
            above[c] += weight * load_lanes<N>(up + c * plane_step);
            below[c] += weight * load_lanes<N>(down + c * plane_step);
        }
    }
    for (int c = 0; c < Count; ++c) {
        store_lanes<N>(upper_sums + c * row_tile, above[c]);
        store_lanes<N>(lower_sums + c * row_tile, below[c]);
    }
}

/// Computes the near sums of the texels in columns [column, column + row_tile) of the rows `row`
/// and S - 1 - row of a face of S x S texels. If `coarse`, a map of half the size, is not null, it
/// is upsampled and added.
template <int N>
ITEM3D_ALWAYS_INLINE inline void near_sums(const NearParameters& p, const ConstPlanes* coarse,
                                           int row, int column, NearSums& sums) {
    const std::int64_t row_step = p.source.row_step(), plane_step = p.source.plane_step();
    const int rows[2] = {row, p.source.size - 1 - row};
    for (int half = 0; half < 2; ++half)
        for (int plane = 0; plane < p.source.count; ++plane) {
            float* out = sums.rows[half][plane];
            if (coarse != nullptr)
                upsample_run<row_tile>(coarse->row(plane, 0), coarse->row_step(), rows[half],
                                       column, out);
            else
                std::fill_n(out, row_tile, 0.0f);
        }
    constexpr int groups = row_tile / N;
    NearTaps<N> taps[groups];
    for (int group = 0; group < groups; ++group)
        near_taps<N>(p, row, column + group * N, taps[group]);
    const float* upper = p.source.values + rows[0] * row_step + column;
    const float* lower = p.source.values + rows[1] * row_step + column;
    const auto add = [&]<int Count>(std::integral_constant<int, Count>, int plane) {
        for (int group = 0; group < row_tile; group += N)
            add_near<N, Count>(taps[group / N], upper + plane * plane_step + group,
                               lower + plane * plane_step + group, plane_step,
                               sums.rows[0][plane] + group, sums.rows[1][plane] + group);
    };
    // Four planes are processed at a time. They are few enough for their neighbourhood to stay in
    // the L1 cache while all groups read it, and enough for additions not to wait for each other.
    for (int plane = 0; plane < 16; plane += 4)
        add(std::integral_constant<int, 4>{}, plane);
    if (p.source.count == 19)
        add(std::integral_constant<int, 3>{}, 16);
    else
        add(std::integral_constant<int, 2>{}, 16);
}

/// Kernel values of several rows of texels, and their weighted sums for all planes of the output.
template <int N>
struct FarBatch {
    /// Limits for 16 KB of weights, which stay in the L1 cache while each plane is read.
    static constexpr int max_weights = 4096, max_rows = 128;
    Lanes<N> weights[max_weights / N];
    std::int64_t first[max_rows];  ///< index into a plane
    int groups[max_rows];          ///< number of vectors
    int rows = 0, used = 0;
    Lanes<N> sums[max_planes] = {};  ///< one sum for every N-th texel

    /// Adds Count planes from `plane` on. Count is large enough that additions do not wait for each
    /// other.
    template <int Count>
    ITEM3D_ALWAYS_INLINE void add(const FarParameters& p, int plane) {
        const std::int64_t step = far_plane(p.source_size);
        const float* source = p.source + plane * step;
        Lanes<N> sum[Count];
        for (int i = 0; i < Count; ++i)
            sum[i] = sums[plane + i];
        const Lanes<N>* k = weights;
        for (int row = 0; row < rows; ++row) {
            const float* values = source + first[row];
            for (int group = 0; group < groups[row]; ++group, ++k, values += N)
#pragma GCC unroll 9
                for (int i = 0; i < Count; ++i)
                    sum[i] += *k * load_lanes<N>(values + i * step);
        }
        for (int i = 0; i < Count; ++i)
            sums[plane + i] = sum[i];
    }
    ITEM3D_ALWAYS_INLINE void add(const FarParameters& p) {
        int plane = 0;
        for (; plane + 9 <= p.planes; plane += 9)
            add<9>(p, plane);
        if (plane < p.planes) add<1>(p, plane);
        rows = used = 0;
    }
};

/// Sums one texel for all faces of the output. index: row * R + column. Rows and tables have a
/// multiple of N texels, and texels outside the cone add nothing, so ranges are rounded out to
/// whole vectors. AbsoluteCosine: true for k = |n.l| over the faces 0, 2 and 4 only.
template <int N, bool AbsoluteCosine>
ITEM3D_ALWAYS_INLINE inline void far_sums(const FarParameters& p, std::int64_t index) {
    const int out_row = static_cast<int>(index / p.out.size);
    const int out_column = static_cast<int>(index % p.out.size);
    const Vec3 n = unit_direction(0, out_row, out_column, p.out.size);
    const int size = p.source_size;
    const ZonalKernel kernel = p.kernel;
    FarBatch<N> batch;
    for (int face = 0; face < 6; face += AbsoluteCosine ? 2 : 1) {
        const FaceReach reach = face_reach<AbsoluteCosine>(p, face, n);
        if (reach.columns.begin >= reach.columns.end) continue;
        const int first = reach.columns.begin / N * N;
        const int groups = (reach.columns.end - first + N - 1) / N;
        for (int row = reach.rows.begin; row < reach.rows.end; ++row) {
            if (batch.rows == FarBatch<N>::max_rows ||
                N * (batch.used + groups) > FarBatch<N>::max_weights)
                batch.add(p);
            const float rest = reach.along_t * p.centres[row] + reach.normal;
            const float* lengths = p.inverse_lengths + row * size + first;
            const float* centres = p.centres + first;
            for (int i = 0; i < groups; ++i) {
                const Lanes<N> c = (reach.along_s * load_lanes<N>(centres + i * N) + rest) *
                                   load_lanes<N>(lengths + i * N);
                if constexpr (AbsoluteCosine)
                    batch.weights[batch.used++] = c < 0 ? -c : c;
                else
                    batch.weights[batch.used++] = kernel.value(2 - 2 * c);
            }
            batch.first[batch.rows] = (face * size + row) * far_row(size) + first;
            batch.groups[batch.rows++] = groups;
        }
    }
    batch.add(p);
    for (int plane = 0; plane < p.planes; ++plane) {
        float lanes[N], sum = 0;
        store_lanes<N>(lanes, batch.sums[plane]);
        for (const float lane : lanes)
            sum += lane;
        p.out.row(plane, out_row)[out_column] = sum;
    }
}

}  // namespace item3d::kernels
