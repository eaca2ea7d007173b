// The launches behind RenderTable, each defined in one of the .cu files beside this.
#pragma once

#include "item3d/render/cuda/table.h"

namespace item3d::cuda {

// exact.cu
int project_vertices(const kernels::ProjectParameters& p, std::int64_t count, Stream stream);
int bound_triangles(const kernels::RasterParameters& p, std::int64_t count, Stream stream);
int rasterize_keys(const kernels::KeyedRasterParameters& p, std::int64_t count, Stream stream);
int resolve_keys(const kernels::KeyedRasterParameters& p, std::int64_t count, Stream stream);
int antialias(const kernels::BlendParameters& p, std::int64_t count, Stream stream);
int antialias_backward(const kernels::BlendParameters& p, std::int64_t count, Stream stream);

// surface.cu
int interpolate_surface(const kernels::SurfaceParameters& p, std::int64_t count, Stream stream);
int interpolate(const kernels::InterpolateParameters& p, std::int64_t count, Stream stream);
int interpolate_backward(const kernels::InterpolateParameters& p, std::int64_t count,
                         Stream stream);
int shade(const kernels::ShadeParameters& p, std::int64_t count, Stream stream);
int shade_backward(const kernels::ShadeBackwardParameters& p, std::int64_t count, Stream stream);
int equirectangular(const kernels::EquirectangularParameters& p, std::int64_t count, Stream stream);
int equirectangular_backward(const kernels::EquirectangularParameters& p, std::int64_t count,
                             Stream stream);
int uv_footprints(const kernels::FootprintParameters& p, std::int64_t count, Stream stream);
int scatter_background(const kernels::ScatterParameters& p, std::int64_t count, Stream stream);
int scatter_values(const kernels::ScatterParameters& p, std::int64_t count, Stream stream);
int occlusion(const kernels::OcclusionParameters& p, std::int64_t count, Stream stream);
int finish_sums(const FinishSumsParameters& p, std::int64_t count, Stream stream);

// texture.cu
int texture(const TextureLaunchParameters& p, std::int64_t count, Stream stream);
int texture_backward(const TextureLaunchParameters& p, std::int64_t count, Stream stream);
int texture_uv_backward(const TextureLaunchParameters& p, std::int64_t count, Stream stream);
int halve_texture(const kernels::HalveParameters& p, std::int64_t count, Stream stream);
int halve_texture_backward(const kernels::HalveParameters& p, std::int64_t count, Stream stream);

// light.cu
int fill_halo_side(const kernels::HaloParameters& p, std::int64_t count, Stream stream);
int fill_halo_corner(const kernels::HaloParameters& p, std::int64_t count, Stream stream);
int upsample_cube(const kernels::ResizeParameters& p, std::int64_t count, Stream stream);
int restrict_cube(const kernels::ResizeParameters& p, std::int64_t count, Stream stream);
int map_to_planes(const kernels::MapToPlanesParameters& p, std::int64_t count, Stream stream);
int planes_to_map(const kernels::PlanesToMapParameters& p, std::int64_t count, Stream stream);
int planes_to_means(const kernels::MeansParameters& p, std::int64_t count, Stream stream);
int cube_directions(const kernels::DirectionParameters& p, std::int64_t count, Stream stream);
int add_near_sums(const kernels::NearParameters& p, std::int64_t count, Stream stream);
int turn_planes(const kernels::TurnParameters& p, std::int64_t count, Stream stream);
int far_sums(const kernels::FarParameters& p, std::int64_t count, Stream stream);
int far_absolute_cosine(const kernels::FarParameters& p, std::int64_t count, Stream stream);
int fold(const kernels::FoldParameters& p, std::int64_t count, Stream stream);
int row_moments(const kernels::MomentParameters& p, std::int64_t count, Stream stream);
int join_cosine(const kernels::CosineParameters& p, std::int64_t count, Stream stream);
int add_bright(const kernels::BrightParameters& p, std::int64_t count, Stream stream);
int sum_bright(const kernels::BrightParameters& p, std::int64_t count, Stream stream);
int set_bright(const kernels::BrightParameters& p, std::int64_t count, Stream stream);

}  // namespace item3d::cuda
