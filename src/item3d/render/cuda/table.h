// What libitem3d_cuda.so offers to the renderer: one entry for each kernel launch. No torch here,
// because nvcc reads this too. Entries take pointers to memory of one device, which must be the
// current one, launch on `stream` (a cudaStream_t) without waiting, and return a cudaError_t.
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/render/kernels/antialias.h"
#include "item3d/render/kernels/equirectangular.h"
#include "item3d/render/kernels/footprint.h"
#include "item3d/render/kernels/interpolate.h"
#include "item3d/render/kernels/irradiance.h"
#include "item3d/render/kernels/occlusion.h"
#include "item3d/render/kernels/project.h"
#include "item3d/render/kernels/raster.h"
#include "item3d/render/kernels/scatter.h"
#include "item3d/render/kernels/shade.h"
#include "item3d/render/kernels/texture.h"
#include "item3d/render/kernels/zonal.h"

#include <cstdint>

namespace item3d::cuda {

using Stream = void*;

template <typename Parameters>
using Kernel = int (*)(const Parameters& parameters, std::int64_t count, Stream stream);

/// What every table begins with, so that a module of another build is noticed.
struct TableHeader {
    std::uint32_t version;  ///< table_version of the sources that the module was built from
    std::uint32_t size;     ///< of the whole table in bytes
};

/// To be raised by whoever changes a table or the parameters of one of its kernels.
inline constexpr std::uint32_t table_version = 3;

/// A texture lookup and its gradients, with what each of them reads and writes.
struct TextureLaunchParameters {
    kernels::TextureParameters texture;
    float* values;                ///< [P, C]
    const float* value_gradient;  ///< [P, C]
    float* uv_gradient;           ///< [P, 2]
    Accumulator texel_gradient;   ///< of all levels
};

struct RenderTable {
    TableHeader header;
    const char* (*error_text)(int error);
    Kernel<kernels::ProjectParameters> project_vertices;
    Kernel<kernels::RasterParameters> bound_triangles;
    Kernel<kernels::KeyedRasterParameters> rasterize_keys;
    Kernel<kernels::KeyedRasterParameters> resolve_keys;
    Kernel<kernels::SurfaceParameters> interpolate_surface;
    Kernel<kernels::InterpolateParameters> interpolate;
    Kernel<kernels::InterpolateParameters> interpolate_backward;
    Kernel<kernels::ShadeParameters> shade;
    Kernel<kernels::ShadeBackwardParameters> shade_backward;
    Kernel<kernels::BlendParameters> antialias;
    Kernel<kernels::BlendParameters> antialias_backward;
    Kernel<kernels::EquirectangularParameters> equirectangular;
    Kernel<kernels::EquirectangularParameters> equirectangular_backward;
    Kernel<kernels::FootprintParameters> uv_footprints;
    Kernel<TextureLaunchParameters> texture;
    Kernel<TextureLaunchParameters> texture_backward;
    Kernel<TextureLaunchParameters> texture_uv_backward;
    Kernel<kernels::HalveParameters> halve_texture;           ///< count: coarse texels
    Kernel<kernels::HalveParameters> halve_texture_backward;  ///< count: coarse texels
    Kernel<kernels::ScatterParameters> scatter_background;    ///< count: pixels
    Kernel<kernels::ScatterParameters> scatter_values;        ///< count: values
    Kernel<FinishSumsParameters> finish_sums;
    Kernel<kernels::OcclusionParameters> occlusion;
    Kernel<kernels::HaloParameters> fill_halo_side;
    Kernel<kernels::HaloParameters> fill_halo_corner;
    Kernel<kernels::ResizeParameters> upsample_cube;
    Kernel<kernels::ResizeParameters> restrict_cube;
    Kernel<kernels::MapToPlanesParameters> map_to_planes;
    Kernel<kernels::PlanesToMapParameters> planes_to_map;
    Kernel<kernels::MeansParameters> planes_to_means;
    Kernel<kernels::DirectionParameters> cube_directions;
    Kernel<kernels::NearParameters> add_near_sums;
    Kernel<kernels::TurnParameters> turn_planes;
    Kernel<kernels::FarParameters> far_sums;
    Kernel<kernels::FarParameters> far_absolute_cosine;
    Kernel<kernels::FoldParameters> fold;
    Kernel<kernels::MomentParameters> row_moments;
    Kernel<kernels::CosineParameters> join_cosine;
    Kernel<kernels::BrightParameters> add_bright;
    Kernel<kernels::BrightParameters> sum_bright;
    Kernel<kernels::BrightParameters> set_bright;
};

/// Exported as item3d_cuda_render.
using RenderTableFunction = const RenderTable*();

}  // namespace item3d::cuda
