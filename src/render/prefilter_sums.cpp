#include "item3d/render/prefilter_sums.h"

#include "item3d/core/math.h"
#include "item3d/core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace item3d {

using kernels::CubePlanes;
using kernels::FarParameters;
using kernels::NearParameters;
using kernels::NearSums;
using kernels::row_tile;
using kernels::ZonalKernel;

namespace {

/// The sums, which take most of the time, for the processor at hand.
struct SumKernels {
    void (*near)(const NearParameters&, int row, int column, NearSums&);
    void (*far)(const FarParameters&, std::int64_t index);
    void (*far_absolute_cosine)(const FarParameters&, std::int64_t index);
};

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2,fma"))) void near_avx2(const NearParameters& p, int row, int column,
                                                   NearSums& sums) {
    kernels::near_sums<8>(p, row, column, sums);
}
template <bool AbsoluteCosine>
__attribute__((target("avx2,fma"))) void far_avx2(const FarParameters& p, std::int64_t index) {
    kernels::far_sums<8, AbsoluteCosine>(p, index);
}
SumKernels sum_kernels() {
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        return {near_avx2, far_avx2<false>, far_avx2<true>};
    return {kernels::near_sums<4>, kernels::far_sums<4, false>, kernels::far_sums<4, true>};
}
#else
SumKernels sum_kernels() {
    return {kernels::near_sums<4>, kernels::far_sums<4, false>, kernels::far_sums<4, true>};
}
#endif

/// A map for far sums: FarParameters::source.
struct TurnedPlanes {
    int size, count;
    std::vector<float> values;
};
/// faces: to turn for, so many in steps of 6 / faces.
TurnedPlanes turned_planes(const CubePlanes& map, int faces) {
    const int size = map.size(), count = 3 * faces + (map.shared_plane() ? 1 : 0);
    const std::int64_t step = kernels::far_plane(size), row_step = kernels::far_row(size);
    TurnedPlanes turned{size, count, std::vector<float>(static_cast<std::size_t>(step * count))};
    parallel_for(
        "turn_planes", 6 * static_cast<std::int64_t>(count),
        [&](std::int64_t i) {
            const int plane = static_cast<int>(i / 6), face = static_cast<int>(i % 6);
            const bool shared = plane == 3 * faces;
            const kernels::TurnedFace from = kernels::turned_face(
                shared ? 0 : plane / 3 * (6 / faces), face, size, map.row_step());
            const float* in = map.plane(shared ? 18 : 3 * from.face + plane % 3) + from.first;
            float* out = turned.values.data() + plane * step + face * size * row_step;
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x)
                    out[y * row_step + x] = in[y * from.row_step + x * from.column_step];
        },
        1);
    return turned;
}

/// Of a turned map, to the planes of `out` from the first on.
void sum_far(const TurnedPlanes& map, const ZonalKernel& kernel, CubePlanes& out) {
    const int size = map.size, out_size = out.size();
    std::vector<float> centres(static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i)
        centres[static_cast<std::size_t>(i)] = kernels::texel_centre(i, size);
    std::vector<float> inverse_lengths;
    inverse_lengths.reserve(centres.size() * centres.size());
    for (const float t : centres)
        for (const float s : centres)
            inverse_lengths.push_back(1 / std::sqrt(1 + s * s + t * t));
    const float reach = kernel.reach();
    // The corners of a face are 54.7 degrees off its centre.
    const float farthest = reach + 0.9554f;
    const FarParameters parameters{kernel,
                                   map.values.data(),
                                   size,
                                   map.count,
                                   out.plane(0),
                                   out.row_step(),
                                   out.plane_step(),
                                   out_size,
                                   centres.data(),
                                   inverse_lengths.data(),
                                   std::sin(std::min(reach, 0.5f * pi)),
                                   farthest < pi ? std::cos(farthest) : -1.0f};
    const SumKernels sums = sum_kernels();
    const auto sum = kernel.cosine ? sums.far_absolute_cosine : sums.far;
    parallel_for(
        "far_sums", static_cast<std::int64_t>(out_size) * out_size,
        [&](std::int64_t i) { sum(parameters, i); }, 16);
}

/// A texel's index on the face opposite, where the direction is the negative.
struct Antipode {
    int row, column;
};
Antipode antipode(int face, int row, int column, int size) {
    const bool sides = face / 2 != 1;
    return {sides ? size - 1 - row : row, sides ? column : size - 1 - column};
}

/// map(d) + map(-d)
CubePlanes folded(const CubePlanes& map) {
    const int size = map.size();
    CubePlanes sums(size, map.shared_plane());
    for (int plane = 0; plane < map.count(); ++plane) {
        const int face = plane < 18 ? plane / 3 : 0;
        const int opposite = plane < 18 ? 3 * (face ^ 1) + plane % 3 : plane;
        for (int row = 0; row < size; ++row)
            for (int column = 0; column < size; ++column) {
                const Antipode other = antipode(face, row, column, size);
                sums.row(plane, row)[column] =
                    map.row(plane, row)[column] + map.row(opposite, other.row)[other.column];
            }
    }
    return sums;
}

/// Calls f(face, row, column, unit direction) for all texels.
template <typename F>
void for_each_direction(int size, const F& f) {
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row < size; ++row)
            for (int column = 0; column < size; ++column)
                f(face, row, column,
                  glm::normalize(kernels::cube_direction(face, kernels::texel_centre(column, size),
                                                         kernels::texel_centre(row, size))));
}

}  // namespace

CubeDirections::CubeDirections(int size)
    : row_(size + 2 * CubePlanes::halo),
      values_(std::make_unique<float[]>(static_cast<std::size_t>(3 * row_ * row_))) {
    constexpr int halo = CubePlanes::halo;
    parallel_for(
        "cube_directions", row_,
        [&](std::int64_t row) {
            const int y = static_cast<int>(row) - halo;
            for (int x = -halo; x < size + halo; ++x) {
                const bool off_x = x < 0 || x >= size, off_y = y < 0 || y >= size;
                if (off_x && off_y) continue;  // 0 is out of any near texel's reach
                Vec3 d;
                if (off_x)
                    d = kernels::halo_direction(0, x < 0 ? 0 : 1, y, x < 0 ? -x : x - size + 1,
                                                size);
                else if (off_y)
                    d = kernels::halo_direction(0, y < 0 ? 2 : 3, x, y < 0 ? -y : y - size + 1,
                                                size);
                else
                    d = kernels::cube_direction(0, kernels::texel_centre(x, size),
                                                kernels::texel_centre(y, size));
                d = glm::normalize(d);
                for (int c = 0; c < 3; ++c)
                    values_[static_cast<std::size_t>((c * row_ + row) * row_ + x + halo)] = d[c];
            }
        },
        16);
}
void near_sums(const CubePlanes& source, const CubeDirections& directions,
               const ZonalKernel& kernel, const CubePlanes* coarse, const RowSums& finish) {
    const int size = source.size();
    const NearParameters parameters{kernel,
                                    directions.data(),
                                    directions.plane_step(),
                                    source.plane(0),
                                    source.row_step(),
                                    source.plane_step(),
                                    size,
                                    source.count(),
                                    std::sin(kernel.reach()),
                                    coarse != nullptr ? coarse->plane(0) : nullptr,
                                    coarse != nullptr ? coarse->row_step() : 0,
                                    coarse != nullptr ? coarse->plane_step() : 0};
    const auto sum = sum_kernels().near;
    // Columns of tiles: the next row's neighbourhood is in a core's cache for the most part.
    parallel_for(
        "near_sums", static_cast<std::int64_t>(size / row_tile) * (size / 2),
        [&](std::int64_t i) {
            const int row = static_cast<int>(i % (size / 2));
            const int column = static_cast<int>(i / (size / 2)) * row_tile;
            NearSums sums;
            sum(parameters, row, column, sums);
            finish(row, column, sums.rows[0][0]);
            finish(size - 1 - row, column, sums.rows[1][0]);
        },
        16);
}

CubePlanes far_sums(const CubePlanes& source, const ZonalKernel& kernel) {
    CubePlanes out(source.size(), source.shared_plane());
    sum_far(turned_planes(source, 6), kernel, out);
    return out;
}

CubePlanes cosine_sums(const CubePlanes& source, int out_size) {
    // max(0, c) = (c + |c|) / 2. The sums of |c| are even, so half of the texels, folded onto their
    // opposites, and half of the outputs are enough: faces 0, 2 and 4.
    ZonalKernel kernel{};
    kernel.cosine = true;
    kernel.outer = 2;
    CubePlanes even(out_size, source.shared_plane());
    sum_far(turned_planes(folded(source), 3), kernel, even);
    // The sums of c are linear in n: the dot product with a vector a channel.
    std::array<std::array<double, 3>, 3> moments{};
    for_each_direction(source.size(), [&](int face, int row, int column, Vec3 d) {
        for (int c = 0; c < 3; ++c)
            for (int axis = 0; axis < 3; ++axis)
                moments[static_cast<std::size_t>(c)][static_cast<std::size_t>(axis)] +=
                    static_cast<double>(source.row(3 * face + c, row)[column]) * d[axis];
    });
    CubePlanes out(out_size, source.shared_plane());
    for_each_direction(out_size, [&](int face, int row, int column, Vec3 n) {
        const Antipode other =
            face % 2 == 0 ? Antipode{row, column} : antipode(face, row, column, out_size);
        for (int c = 0; c < 3; ++c) {
            const auto& moment = moments[static_cast<std::size_t>(c)];
            const double odd = moment[0] * n.x + moment[1] * n.y + moment[2] * n.z;
            out.row(3 * face + c, row)[column] = static_cast<float>(
                0.5 * (odd + even.row(3 * (face / 2) + c, other.row)[other.column]));
        }
    });
    if (source.shared_plane())
        for (int row = 0; row < out_size; ++row)
            for (int column = 0; column < out_size; ++column)
                out.row(18, row)[column] = 0.5f * even.row(9, row)[column];
    return out;
}

}  // namespace item3d
