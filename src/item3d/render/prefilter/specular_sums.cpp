// Launches of zonal sums. A device uses one thread for each texel. The CPU uses vectors of eight
// floats with AVX2, and of four floats without it. The program decides this when it runs.
//
//     near sums   tasks: columns of 32 texels x pairs of rows (row, S - 1 - row)
//     far sums    a task: one texel of face 0; its six faces and colours are the 18 turned planes
//
//     turned  [planes, 6, S, S + 16] + 48 a plane:  plane 3 f + colour is the map as seen when
//                                                   face f is turned to face 0; the shared last
#include "item3d/render/prefilter/specular_sums.h"

#include "item3d/core/math.h"
#include "item3d/render/kernels/irradiance.h"

#include <algorithm>
#include <cmath>

namespace item3d {

using cuda::RenderTable;
using kernels::ConstPlanes;
using kernels::FarParameters;
using kernels::NearParameters;
using kernels::NearSums;
using kernels::row_tile;
using kernels::ZonalKernel;

namespace {

/// The summation kernels for the current processor. They take most of the time.
struct SumKernels {
    void (*near)(const NearParameters&, const ConstPlanes* coarse, int row, int column, NearSums&);
    void (*far)(const FarParameters&, std::int64_t index);
    void (*far_absolute_cosine)(const FarParameters&, std::int64_t index);
};

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2,fma"))) void near_avx2(const NearParameters& p,
                                                   const ConstPlanes* coarse, int row, int column,
                                                   NearSums& sums) {
    kernels::near_sums<8>(p, coarse, row, column, sums);
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

/// A map for far sums (FarParameters::source): planes of [6 * S, S], rows and planes padded. For
/// each face of the output it has the map's three colour planes, rotated so that this face becomes
/// face 0 (see turned_face). The shared plane, if any, follows.
struct TurnedPlanes {
    int size, count;
    Floats values;
};
/// Returns the rotated map. faces: number of output faces; every (6 / faces)-th face is one.
TurnedPlanes turned_planes(const CubePlanes& map, int faces) {
    const PrefilterBackend& backend = map.backend();
    const int size = map.size(), count = 3 * faces + (map.shared_plane() ? 1 : 0);
    const std::int64_t floats = count * kernels::far_plane(size);
    TurnedPlanes turned{size, count, backend.allocate(floats)};
    // Sets the padding to 0, because vector loads read it, with weights of 0.
    backend.fill(turned.values.get(), floats, 0);
    const kernels::TurnParameters p{map.view(), turned.values.get(), faces,
                                    run_length(backend, size)};
    run_kernel<kernels::turn_planes>(
        backend, "turn_planes", &RenderTable::turn_planes, p,
        static_cast<std::int64_t>(6) * count * size * (size / p.length), 16);
    return turned;
}

/// Sums a turned map into the first planes of `out`.
void sum_far(const TurnedPlanes& map, const ZonalKernel& kernel, CubePlanes& out) {
    const PrefilterBackend& backend = out.backend();
    const int size = map.size, out_size = out.size();
    const Floats tables = backend.far_tables(size);
    const float reach = kernel.reach();
    // The corners of a face are 54.7 degrees (0.9554) off its centre.
    const float farthest = reach + 0.9554f;
    const FarParameters p{kernel,
                          map.values.get(),
                          size,
                          map.count,
                          out.writable(),
                          tables.get(),
                          tables.get() + size,
                          std::sin(std::min(reach, 0.5f * pi)),
                          farthest < pi ? std::cos(farthest) : -1.0f};
    const std::int64_t count = static_cast<std::int64_t>(out_size) * out_size;
    if (backend.on_device()) {
        backend.launch([&](const RenderTable& table, cuda::Stream stream) {
            return (kernel.cosine ? table.far_absolute_cosine : table.far_sums)(p, count, stream);
        });
        return;
    }
    const SumKernels sums = sum_kernels();
    const auto sum = kernel.cosine ? sums.far_absolute_cosine : sums.far;
    parallel_for(
        "far_sums", count, [&](std::int64_t i) { sum(p, i); }, 16);
}

/// Returns map(d) + map(-d).
CubePlanes folded(const CubePlanes& map) {
    CubePlanes sums(map.size(), map.shared_plane(), map.backend());
    const kernels::FoldParameters p{map.view(), sums.writable(),
                                    run_length(map.backend(), map.size())};
    run_kernel<kernels::fold>(
        map.backend(), "fold", &RenderTable::fold, p,
        static_cast<std::int64_t>(map.count()) * map.size() * (map.size() / p.length), 64);
    return sums;
}

NearParameters near_parameters(const CubePlanes& source, const CubeDirections& directions,
                               const ZonalKernel& kernel) {
    return {kernel,        directions.data(),        directions.plane_step(),
            source.view(), std::sin(kernel.reach()), {}};
}

}  // namespace

CubeDirections::CubeDirections(int size, const PrefilterBackend& backend)
    : row_(size + 2 * CubePlanes::halo), values_(backend.allocate(3 * row_ * row_)) {
    run_kernel<kernels::halo_texel_direction>(
        backend, "cube_directions", &RenderTable::cube_directions,
        kernels::DirectionParameters{values_.get(), size}, row_ * row_, 4096);
}

const float* CubeDirections::data() const {
    return values_.get() + CubePlanes::halo * (row_ + 1);
}

void near_sums(const CubePlanes& source, const CubeDirections& directions,
               const ZonalKernel& kernel, const CubePlanes* coarse, const RowSums& finish) {
    const int size = source.size();
    const NearParameters parameters = near_parameters(source, directions, kernel);
    ConstPlanes coarse_view{};
    if (coarse != nullptr) coarse_view = coarse->view();
    const auto sum = sum_kernels().near;
    // Processes tiles column by column, so that most of the next row's neighbourhood is in a core's
    // cache.
    parallel_for(
        "near_sums", static_cast<std::int64_t>(size / row_tile) * (size / 2),
        [&](std::int64_t i) {
            const int row = static_cast<int>(i % (size / 2));
            const int column = static_cast<int>(i / (size / 2)) * row_tile;
            NearSums sums;
            sum(parameters, coarse != nullptr ? &coarse_view : nullptr, row, column, sums);
            finish(row, column, sums.rows[0][0]);
            finish(size - 1 - row, column, sums.rows[1][0]);
        },
        16);
}

void add_near_sums(const CubePlanes& source, const CubeDirections& directions,
                   const ZonalKernel& kernel, CubePlanes& to) {
    NearParameters p = near_parameters(source, directions, kernel);
    p.out = to.writable();
    run_kernel<kernels::add_near_sums>(source.backend(), "near_sums", &RenderTable::add_near_sums,
                                       p, static_cast<std::int64_t>(source.size()) * source.size());
}

CubePlanes far_sums(const CubePlanes& source, const ZonalKernel& kernel) {
    CubePlanes out(source.size(), source.shared_plane(), source.backend());
    sum_far(turned_planes(source, 6), kernel, out);
    return out;
}

CubePlanes cosine_sums(const CubePlanes& source, int out_size) {
    const PrefilterBackend& backend = source.backend();
    ZonalKernel kernel{};
    kernel.cosine = true;
    kernel.outer = 2;
    CubePlanes even(out_size, source.shared_plane(), backend);
    sum_far(turned_planes(folded(source), 3), kernel, even);

    const std::int64_t rows = static_cast<std::int64_t>(6) * source.size();
    const Floats row_moments = backend.allocate(9 * rows), moments = backend.allocate(9);
    run_kernel<kernels::row_moments>(backend, "row_moments", &RenderTable::row_moments,
                                     kernels::MomentParameters{source.view(), row_moments.get()},
                                     rows, 16);
    backend.sum_rows(row_moments.get(), rows, 9, /*precise=*/true, moments.get());

    CubePlanes out(out_size, source.shared_plane(), backend);
    const kernels::CosineParameters p{even.view(), moments.get(), out.writable(),
                                      run_length(backend, out_size)};
    run_kernel<kernels::join_cosine>(
        backend, "join_cosine", &RenderTable::join_cosine, p,
        static_cast<std::int64_t>(source.shared_plane() ? 7 : 6) * out_size * (out_size / p.length),
        64);
    return out;
}

}  // namespace item3d
