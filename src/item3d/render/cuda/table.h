// The table of the renderer's kernels in libitem3d_cuda.so. An entry is a function that launches
// one kernel on `stream` (a cudaStream_t) without blocking, and returns a cudaError_t. Its
// parameters have pointers to memory of one device, which must be the current device. This file
// includes no torch header, because nvcc compiles it too.
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/render/kernels/antialias.h"
#include "item3d/render/kernels/equirectangular.h"
#include "item3d/render/kernels/footprint.h"
#include "item3d/render/kernels/interpolate.h"
#include "item3d/render/kernels/irradiance.h"
#include "item3d/render/kernels/mipmap.h"
#include "item3d/render/kernels/occlusion.h"
#include "item3d/render/kernels/pixel_raster.h"
#include "item3d/render/kernels/project.h"
#include "item3d/render/kernels/raster.h"
#include "item3d/render/kernels/scatter.h"
#include "item3d/render/kernels/shade.h"
#include "item3d/render/kernels/srgb.h"
#include "item3d/render/kernels/texture.h"
#include "item3d/render/kernels/values.h"
#include "item3d/render/kernels/zonal.h"

#include <cstdint>

namespace item3d::cuda {

using Stream = void*;

template <typename Parameters>
using Kernel = int (*)(const Parameters& parameters, std::int64_t count, Stream stream);

/// Header of every table, by which a module of another build is recognised.
struct TableHeader {
    std::uint32_t version;  ///< table_version of the module's sources
    std::uint32_t size;     ///< size of the whole table in bytes
};

/// Version to increment with every change of a table or of its kernels' parameters.
inline constexpr std::uint32_t table_version = 8;

/// Parameters of a texture lookup and its gradients.
struct TextureLaunchParameters {
    kernels::TextureParameters texture;
    float* values;                ///< [P, C]
    const float* value_gradient;  ///< [P, C]
    float* uv_gradient;           ///< [P, 2]
    Accumulator texel_gradient;   ///< gradients of all levels
};

/// Parameters of a kernel that adds to sums, apart from its own parameters.
template <typename Parameters>
struct SumParameters {
    Parameters own;
    Accumulator sums;
};

// The renderer's kernels. Each .cu file has a list, with one line for each of its kernels. The
// lists generate the table's members, the launching functions (launch.h) and the table itself. To
// add a kernel, write its function and its line here, and raise table_version. The line
//     X(shade, kernels::ShadeParameters, kernels::shade_forward(p, i), "shade"),
// has the entry's name in the table, the type of p, the expression for an index i in [0, count),
// and the name for profilers. ITEM3D_KERNEL_MEMBER expands the line to
//     Kernel<kernels::ShadeParameters> shade;
// and ITEM3D_KERNEL_DEFINITION, in launch.h, expands it to the function that launches the kernel.

/// exact.cu: kernels with decisions (inside or outside, nearer or farther, crossed or not). The
/// file is compiled with -fmad=false (cmake/Cuda.cmake), because without fused products the
/// decisions equal the CPU's bit for bit.
#define ITEM3D_EXACT_KERNELS(X)                                                                   \
    X(project_vertices, kernels::ProjectParameters, kernels::project_vertex(p, i),                \
      "project_vertices")                                                                         \
    X(bound_triangles, kernels::RasterParameters,                                                 \
      kernels::bound_triangle(p, i / p.triangle_count, i % p.triangle_count), "bound_triangles")  \
    X(rasterize_keys, kernels::KeyedRasterParameters, kernels::rasterize_keys(p, i), "rasterize") \
    X(resolve_keys, kernels::KeyedRasterParameters, kernels::resolve_key(p, i), "resolve_raster") \
    X(antialias, kernels::BlendParameters, kernels::blend_pixel(p, i), "antialias")               \
    X(antialias_backward, kernels::BlendParameters, kernels::blend_pixel_backward(p, i),          \
      "antialias backward")

/// surface.cu: kernels over surface points and texels. count is a number of pixels for
/// scatter_background, and a number of values for scatter_values.
#define ITEM3D_SURFACE_KERNELS(X)                                                                  \
    X(interpolate_surface, kernels::SurfaceParameters, kernels::interpolate_surface_point(p, i),   \
      "interpolate_surface")                                                                       \
    X(interpolate, kernels::InterpolateParameters, kernels::interpolate_forward(p, i),             \
      "interpolate")                                                                               \
    X(interpolate_backward, kernels::InterpolateParameters, kernels::interpolate_backward(p, i),   \
      "interpolate backward")                                                                      \
    X(shade, kernels::ShadeParameters, kernels::shade_forward(p, i), "shade")                      \
    X(shade_backward, kernels::ShadeBackwardParameters,                                            \
      kernels::shade_backward(p.shade, i, p.light), "shade backward")                              \
    X(equirectangular, kernels::EquirectangularParameters, kernels::equirectangular_forward(p, i), \
      "equirectangular_to_cube")                                                                   \
    X(equirectangular_backward, kernels::EquirectangularParameters,                                \
      kernels::equirectangular_backward(p, i), "equirectangular_to_cube backward")                 \
    X(uv_footprints, kernels::FootprintParameters, kernels::uv_footprint(p, i), "uv_footprints")   \
    X(scatter_background, kernels::ScatterParameters, kernels::scatter_background(p, i),           \
      "scatter background")                                                                        \
    X(scatter_values, kernels::ScatterParameters, kernels::scatter_value(p, i), "scatter")         \
    X(linear_to_srgb, kernels::CurveParameters, kernels::linear_to_srgb(p, i), "linear_to_srgb")   \
    X(linear_to_srgb_backward, kernels::CurveParameters, kernels::linear_to_srgb_backward(p, i),   \
      "linear_to_srgb backward")                                                                   \
    X(srgb_to_linear, kernels::CurveParameters, kernels::srgb_to_linear(p, i), "srgb_to_linear")   \
    X(srgb_to_linear_backward, kernels::CurveParameters, kernels::srgb_to_linear_backward(p, i),   \
      "srgb_to_linear backward")                                                                   \
    X(occlusion, kernels::OcclusionParameters, kernels::occlusion_at(p, i), "occlusion")           \
    X(finish_sums, FinishSumsParameters, finish_sum(p, i), "finish_sums")

/// texture.cu: texture lookups and mip levels. count is a number of coarse texels for halve_texture
/// and its gradient.
#define ITEM3D_TEXTURE_KERNELS(X)                                                              \
    X(texture, TextureLaunchParameters, kernels::texture_forward(p.texture, i, p.values),      \
      "sample_texture")                                                                        \
    X(texture_backward, TextureLaunchParameters,                                               \
      kernels::texture_backward(p.texture, i, p.value_gradient, p.texel_gradient),             \
      "sample_texture backward")                                                               \
    X(texture_uv_backward, TextureLaunchParameters,                                            \
      kernels::texture_uv_backward(p.texture, i, p.value_gradient, p.uv_gradient),             \
      "sample_texture by uv")                                                                  \
    X(halve_texture, kernels::HalveParameters, kernels::halve_texture(p, i), "halve_texture")  \
    X(halve_texture_backward, kernels::HalveParameters, kernels::halve_texture_backward(p, i), \
      "halve_texture backward")

/// light.cu: prefiltering of environments.
#define ITEM3D_LIGHT_KERNELS(X)                                                                 \
    X(fill_halo_side, kernels::HaloParameters, kernels::fill_halo_side(p, i), "fill_halo")      \
    X(fill_halo_corner, kernels::HaloParameters, kernels::fill_halo_corner(p, i),               \
      "fill_halo corners")                                                                      \
    X(upsample_cube, kernels::ResizeParameters,                                                 \
      kernels::upsample<kernels::device_resized_run>(p, i), "upsample_cube")                    \
    X(restrict_cube, kernels::ResizeParameters,                                                 \
      kernels::restrict_run<kernels::device_resized_run>(p, i), "restrict_cube")                \
    X(map_to_planes, kernels::MapToPlanesParameters, kernels::map_to_planes(p, i),              \
      "map_to_planes")                                                                          \
    X(planes_to_map, kernels::PlanesToMapParameters, kernels::planes_to_map(p, i),              \
      "planes_to_map")                                                                          \
    X(planes_to_means, kernels::MeansParameters, kernels::planes_to_means(p, i),                \
      "planes_to_means")                                                                        \
    X(cube_directions, kernels::DirectionParameters, kernels::halo_texel_direction(p, i),       \
      "cube_directions")                                                                        \
    X(add_near_sums, kernels::NearParameters, kernels::add_near_sums(p, i), "near_sums")        \
    X(turn_planes, kernels::TurnParameters, kernels::turn_planes(p, i), "turn_planes")          \
    X(far_sums, kernels::FarParameters, kernels::far_sums_of_texel<false>(p, i), "far_sums")    \
    X(far_absolute_cosine, kernels::FarParameters, kernels::far_sums_of_texel<true>(p, i),      \
      "far_sums of cosines")                                                                    \
    X(fold, kernels::FoldParameters, kernels::fold(p, i), "fold")                               \
    X(row_moments, kernels::MomentParameters, kernels::row_moments(p, i), "row_moments")        \
    X(join_cosine, kernels::CosineParameters, kernels::join_cosine(p, i), "join_cosine")        \
    X(add_bright, kernels::BrightParameters, kernels::add_bright<1>(p, i), "bright_irradiance") \
    X(sum_bright, kernels::BrightParameters,                                                    \
      kernels::sum_bright<kernels::device_bright_run>(p, i), "bright_irradiance backward")      \
    X(set_bright, kernels::BrightParameters, kernels::set_bright(p, i), "set_bright")

/// operators.cu: kernels of the Python package's operators.
#define ITEM3D_OPERATOR_KERNELS(X)                                                                \
    X(fill_value, kernels::ValueParameters, kernels::fill_value(p, i), "fill")                    \
    X(add_value, kernels::ValueParameters, kernels::add_value(p, i), "add")                       \
    X(negate_second_of_four, kernels::ValueParameters, kernels::negate_second_of_four(p, i),      \
      "negate_second_of_four")                                                                    \
    X(copy_word, kernels::CopyParameters, kernels::copy_word(p, i), "copy")                       \
    X(sum_rows_of_piece, kernels::RowSumParameters, kernels::sum_rows_of_piece(p, i), "sum_rows") \
    X(sum_pieces, kernels::RowSumParameters, kernels::sum_pieces(p, i), "sum_rows of pieces")     \
    X(find_not_finite, kernels::SearchParameters,                                                 \
      kernels::record_invalid(p, i, kernels::is_not_finite(p.values[i])), "find_not_finite")      \
    X(find_invalid_index, kernels::SearchParameters,                                              \
      kernels::record_invalid(p, i, kernels::is_invalid_index(p, i)), "find_invalid_index")       \
    X(find_invalid_neighbour, kernels::SearchParameters,                                          \
      kernels::record_invalid(p, i, kernels::is_invalid_neighbour(p, i)),                         \
      "find_invalid_neighbour")                                                                   \
    X(find_invalid_triangle, kernels::SearchParameters,                                           \
      kernels::record_invalid(p, i, kernels::is_invalid_triangle(p, i)), "find_invalid_triangle") \
    X(pack_raster, kernels::PackParameters, kernels::pack_raster(p, i), "pack_raster")            \
    X(unpack_raster, kernels::UnpackParameters, kernels::unpack_raster(p, i), "unpack_raster")    \
    X(raster_slopes, kernels::RasterSlopeParameters, kernels::raster_slopes(p, i),                \
      "raster_slopes")                                                                            \
    X(raster_backward, SumParameters<kernels::RasterSlopeParameters>,                             \
      kernels::raster_backward(p.own, i, p.sums), "rasterize backward")                           \
    X(pixel_attributes, kernels::PixelAttributeParameters, kernels::pixel_attributes(p, i),       \
      "interpolate pixels")                                                                       \
    X(pixel_attributes_backward, SumParameters<kernels::PixelAttributeParameters>,                \
      kernels::pixel_attributes_backward(p.own, i, p.sums), "interpolate pixels backward")        \
    X(mipmap, kernels::MipmapParameters, kernels::mipmap_forward(p, i), "mipmap")                 \
    X(mipmap_backward, SumParameters<kernels::MipmapParameters>,                                  \
      kernels::mipmap_backward(p.own, i, p.sums), "mipmap backward")                              \
    X(slopes_to_footprint, kernels::SlopeParameters, kernels::slopes_to_footprint(p, i),          \
      "slopes_to_footprint")                                                                      \
    X(shade_pixel, kernels::ShadeParameters, kernels::shade_pixel(p, i), "shade pixels")          \
    X(shade_pixel_backward, kernels::ShadeBackwardParameters,                                     \
      kernels::shade_pixel_backward(p.shade, i, p.light), "shade pixels backward")

/// All kernels, in the order of RenderTable.
#define ITEM3D_RENDER_KERNELS(X) \
    ITEM3D_EXACT_KERNELS(X)      \
    ITEM3D_SURFACE_KERNELS(X)    \
    ITEM3D_TEXTURE_KERNELS(X)    \
    ITEM3D_LIGHT_KERNELS(X)      \
    ITEM3D_OPERATOR_KERNELS(X)

#define ITEM3D_KERNEL_MEMBER(entry, Parameters, ...) Kernel<Parameters> entry;

struct RenderTable {
    TableHeader header;
    const char* (*error_text)(int error);
    ITEM3D_RENDER_KERNELS(ITEM3D_KERNEL_MEMBER)
};

/// Type of the function that the module exports as item3d_cuda_render.
using RenderTableFunction = const RenderTable*();

}  // namespace item3d::cuda
