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
int finish_sums(const FinishSumsParameters& p, std::int64_t count, Stream stream);

// texture.cu
int texture(const TextureLaunchParameters& p, std::int64_t count, Stream stream);
int texture_backward(const TextureLaunchParameters& p, std::int64_t count, Stream stream);
int texture_uv_backward(const TextureLaunchParameters& p, std::int64_t count, Stream stream);
int halve_texture(const kernels::HalveParameters& p, std::int64_t count, Stream stream);
int halve_texture_backward(const kernels::HalveParameters& p, std::int64_t count, Stream stream);

}  // namespace item3d::cuda
