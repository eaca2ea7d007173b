#include "item3d/render/prefilter/cube_planes.h"

#include <algorithm>

namespace item3d {

namespace {

using cuda::RenderTable;
using kernels::HaloParameters;
using kernels::ResizeParameters;

/// Number of texels of a row that one CPU thread resizes together. Neighbouring runs both compute
/// the blend that they share, so longer runs repeat less work. The length must divide the finer
/// map's size.
constexpr int resized_run = 32;

void upsample_into(CubePlanes& to, const CubePlanes& coarse, bool add) {
    const int length = to.backend().on_device() ? kernels::device_resized_run : resized_run;
    const std::int64_t runs = static_cast<std::int64_t>(to.count()) * to.size() * to.size();
    run_kernel<kernels::upsample<resized_run>>(
        to.backend(), "upsample_cube", &RenderTable::upsample_cube,
        ResizeParameters{coarse.view(), to.writable(), add}, runs / length);
}

}  // namespace

CubePlanes::CubePlanes(int size, bool shared_plane, const PrefilterBackend& backend)
    : backend_(&backend), size_(size), count_(shared_plane ? 19 : 18) {
    const kernels::Planes layout{nullptr, size, count_};
    values_ = backend.allocate(count_ * layout.plane_step());
    origin_ = values_.get() + halo * (layout.row_step() + 1);
}

CubePlanes CubePlanes::clone() const {
    CubePlanes copy(size_, shared_plane(), *backend_);
    backend_->copy(values_.get(), floats(), copy.values_.get());
    return copy;
}

CubeMap CubeMap::contiguous(const float* values, int size) {
    const std::int64_t row = 3 * static_cast<std::int64_t>(size);
    return {values, size, {size * row, row, 3, 1}};
}

void fill_halo(CubePlanes& planes, int depth) {
    const HaloParameters p{planes.writable(), depth, run_length(planes.backend(), planes.size())};
    const std::int64_t sides = 4 * planes.count();
    run_kernel<kernels::fill_halo_side>(planes.backend(), "fill_halo", &RenderTable::fill_halo_side,
                                        p, sides * depth * (planes.size() / p.length), 32);
    run_kernel<kernels::fill_halo_corner>(planes.backend(), "fill_halo_corners",
                                          &RenderTable::fill_halo_corner, p, sides, 32);
}

CubePlanes restricted(const CubePlanes& fine) {
    const int size = fine.size() / 2;
    CubePlanes coarse(size, fine.shared_plane(), fine.backend());
    const int length = (fine.backend().on_device() ? kernels::device_resized_run : resized_run) / 2;
    const std::int64_t texels = static_cast<std::int64_t>(fine.count()) * size * size;
    run_kernel<kernels::restrict_run<resized_run>>(
        fine.backend(), "restrict_cube", &RenderTable::restrict_cube,
        ResizeParameters{fine.view(), coarse.writable(), false}, texels / length);
    fill_halo(coarse, CubePlanes::halo);
    return coarse;
}

CubePlanes upsampled(const CubePlanes& coarse) {
    CubePlanes map(2 * coarse.size(), coarse.shared_plane(), coarse.backend());
    upsample_into(map, coarse, false);
    return map;
}

void add_upsampled(CubePlanes& to, const CubePlanes& coarse) {
    upsample_into(to, coarse, true);
}

CubePlanes to_planes(const CubeMap& map, const float* weight, bool shared_plane,
                     const PrefilterBackend& backend) {
    CubePlanes planes(map.size, shared_plane, backend);
    kernels::MapToPlanesParameters p{};
    p.map = map.values;
    std::copy_n(map.step, 4, p.step);
    p.weight = weight;
    p.planes = planes.writable();
    p.length = run_length(backend, map.size);
    run_kernel<kernels::map_to_planes>(
        backend, "map_to_planes", &RenderTable::map_to_planes, p,
        static_cast<std::int64_t>(shared_plane ? 7 : 6) * map.size * (map.size / p.length), 16);
    fill_halo(planes, CubePlanes::halo);
    return planes;
}

void from_planes(const CubePlanes& planes, const float* weight, float* map) {
    const int size = planes.size();
    const kernels::PlanesToMapParameters p{planes.view(), weight, map,
                                           run_length(planes.backend(), size)};
    run_kernel<kernels::planes_to_map>(planes.backend(), "planes_to_map",
                                       &RenderTable::planes_to_map, p,
                                       static_cast<std::int64_t>(6) * size * (size / p.length), 16);
}

}  // namespace item3d
