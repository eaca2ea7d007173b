// Prefiltering of environments.
#include "item3d/render/cuda/entries.h"
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {

using kernels::device_bright_run;
using kernels::device_resized_run;

int fill_halo_side(const kernels::HaloParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "fill_halo", count, [=] __device__(std::int64_t i) { kernels::fill_halo_side(p, i); },
        stream);
}

int fill_halo_corner(const kernels::HaloParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "fill_halo corners", count,
        [=] __device__(std::int64_t i) { kernels::fill_halo_corner(p, i); }, stream);
}

int upsample_cube(const kernels::ResizeParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "upsample_cube", count,
        [=] __device__(std::int64_t i) { kernels::upsample<device_resized_run>(p, i); }, stream);
}

int restrict_cube(const kernels::ResizeParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "restrict_cube", count,
        [=] __device__(std::int64_t i) { kernels::restrict_run<device_resized_run>(p, i); },
        stream);
}

int map_to_planes(const kernels::MapToPlanesParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "map_to_planes", count, [=] __device__(std::int64_t i) { kernels::map_to_planes(p, i); },
        stream);
}

int planes_to_map(const kernels::PlanesToMapParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "planes_to_map", count, [=] __device__(std::int64_t i) { kernels::planes_to_map(p, i); },
        stream);
}

int planes_to_means(const kernels::MeansParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "planes_to_means", count,
        [=] __device__(std::int64_t i) { kernels::planes_to_means(p, i); }, stream);
}

int cube_directions(const kernels::DirectionParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "cube_directions", count,
        [=] __device__(std::int64_t i) { kernels::halo_texel_direction(p, i); }, stream);
}

int add_near_sums(const kernels::NearParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "near_sums", count, [=] __device__(std::int64_t i) { kernels::add_near_sums(p, i); },
        stream);
}

int turn_planes(const kernels::TurnParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "turn_planes", count, [=] __device__(std::int64_t i) { kernels::turn_planes(p, i); },
        stream);
}

int far_sums(const kernels::FarParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "far_sums", count,
        [=] __device__(std::int64_t i) { kernels::far_sums_of_texel<false>(p, i); }, stream);
}

int far_absolute_cosine(const kernels::FarParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "far_sums of cosines", count,
        [=] __device__(std::int64_t i) { kernels::far_sums_of_texel<true>(p, i); }, stream);
}

int fold(const kernels::FoldParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "fold", count, [=] __device__(std::int64_t i) { kernels::fold(p, i); }, stream);
}

int row_moments(const kernels::MomentParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "row_moments", count, [=] __device__(std::int64_t i) { kernels::row_moments(p, i); },
        stream);
}

int join_cosine(const kernels::CosineParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "join_cosine", count, [=] __device__(std::int64_t i) { kernels::join_cosine(p, i); },
        stream);
}

int add_bright(const kernels::BrightParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "bright_irradiance", count,
        [=] __device__(std::int64_t i) { kernels::add_bright<1>(p, i); }, stream);
}

int sum_bright(const kernels::BrightParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "bright_irradiance backward", count,
        [=] __device__(std::int64_t i) { kernels::sum_bright<device_bright_run>(p, i); }, stream);
}

int set_bright(const kernels::BrightParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "set_bright", count, [=] __device__(std::int64_t i) { kernels::set_bright(p, i); }, stream);
}

}  // namespace item3d::cuda
