#include "item3d/render/prefilter/cube_planes.h"

#include "item3d/render/dispatch.h"

#include <algorithm>

namespace item3d {

namespace {

using cuda::RenderTable;
using kernels::HaloParameters;
using kernels::ResizeParameters;

/// Number of texels that a processor's thread resizes together: longer ones compute less of
/// their neighbours' blend again, and must divide the finer map's size.
constexpr int resized_run = 32;

void upsample_into(CubePlanes& to, const CubePlanes& coarse, bool add) {
    const bool on_device = to.device().is_cuda();
    const int length = on_device ? kernels::device_resized_run : resized_run;
    const std::int64_t runs = static_cast<std::int64_t>(to.count()) * to.size() * to.size();
    dispatch<kernels::upsample<resized_run>>(
        to.device(), "upsample_cube", &RenderTable::upsample_cube,
        ResizeParameters{coarse.view(), to.writable(), add}, runs / length);
}

}  // namespace

CubePlanes::CubePlanes(int size, bool shared_plane, at::Device device)
    : size_(size), count_(shared_plane ? 19 : 18) {
    const kernels::Planes layout{nullptr, size, count_};
    values_ = at::empty({count_ * layout.plane_step()},
                        at::TensorOptions().dtype(at::kFloat).device(device));
    origin_ = values_.data_ptr<float>() + halo * (layout.row_step() + 1);
}

CubePlanes CubePlanes::clone() const {
    CubePlanes copy(size_, shared_plane(), device());
    copy.values_.copy_(values_);
    return copy;
}

void fill_halo(CubePlanes& planes, int depth) {
    const HaloParameters p{planes.writable(), depth, run_length(planes.device(), planes.size())};
    const std::int64_t sides = 4 * planes.count();
    dispatch<kernels::fill_halo_side>(planes.device(), "fill_halo", &RenderTable::fill_halo_side, p,
                                      sides * depth * (planes.size() / p.length), 32);
    dispatch<kernels::fill_halo_corner>(planes.device(), "fill_halo_corners",
                                        &RenderTable::fill_halo_corner, p, sides, 32);
}

CubePlanes restricted(const CubePlanes& fine) {
    const int size = fine.size() / 2;
    CubePlanes coarse(size, fine.shared_plane(), fine.device());
    const int length = (fine.device().is_cuda() ? kernels::device_resized_run : resized_run) / 2;
    const std::int64_t texels = static_cast<std::int64_t>(fine.count()) * size * size;
    dispatch<kernels::restrict_run<resized_run>>(
        fine.device(), "restrict_cube", &RenderTable::restrict_cube,
        ResizeParameters{fine.view(), coarse.writable(), false}, texels / length);
    fill_halo(coarse, CubePlanes::halo);
    return coarse;
}

CubePlanes upsampled(const CubePlanes& coarse) {
    CubePlanes map(2 * coarse.size(), coarse.shared_plane(), coarse.device());
    upsample_into(map, coarse, false);
    return map;
}

void add_upsampled(CubePlanes& to, const CubePlanes& coarse) {
    upsample_into(to, coarse, true);
}

CubePlanes to_planes(const at::Tensor& map, const at::Tensor& weight, bool shared_plane) {
    const auto size = static_cast<int>(map.size(1));
    CubePlanes planes(size, shared_plane, map.device());
    kernels::MapToPlanesParameters p{};
    p.map = map.const_data_ptr<float>();
    std::copy_n(map.strides().begin(), 4, p.step);
    p.weight = weight.const_data_ptr<float>();
    p.planes = planes.writable();
    p.length = run_length(map.device(), size);
    dispatch<kernels::map_to_planes>(
        map.device(), "map_to_planes", &RenderTable::map_to_planes, p,
        static_cast<std::int64_t>(shared_plane ? 7 : 6) * size * (size / p.length), 16);
    fill_halo(planes, CubePlanes::halo);
    return planes;
}

at::Tensor from_planes(const CubePlanes& planes, const at::Tensor& weight) {
    const int size = planes.size();
    at::Tensor map = at::empty({6, size, size, 3}, weight.options());
    const kernels::PlanesToMapParameters p{planes.view(), weight.const_data_ptr<float>(),
                                           map.data_ptr<float>(),
                                           run_length(planes.device(), size)};
    dispatch<kernels::planes_to_map>(planes.device(), "planes_to_map", &RenderTable::planes_to_map,
                                     p, static_cast<std::int64_t>(6) * size * (size / p.length),
                                     16);
    return map;
}

}  // namespace item3d
