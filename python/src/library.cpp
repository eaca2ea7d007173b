// Schemas of the operators. Python supplies their shapes under torch.compile and their gradients
// (item3d/_library.py, item3d/_functions.py). Boolean flags have the order of the C++ functions'
// parameters.
#include "python/src/antialias.h"
#include "python/src/interpolate.h"
#include "python/src/prefilter.h"
#include "python/src/rasterize.h"
#include "python/src/shade.h"
#include "python/src/srgb.h"
#include "python/src/tangents.h"
#include "python/src/texture.h"

STABLE_TORCH_LIBRARY(item3d, m) {
    m.def(
        "rasterize(Tensor positions, Tensor triangles, Tensor? ranges, Tensor? behind, int height, "
        "int width, bool by_w, bool bottom_up, bool slopes, bool finite) -> (Tensor, Tensor)");
    m.def(
        "rasterize_backward(Tensor positions, Tensor triangles, Tensor raster, "
        "Tensor raster_gradient, Tensor? slope_gradient, bool bottom_up) -> Tensor");
    m.def(
        "interpolate(Tensor attributes, Tensor raster, Tensor triangles, Tensor? slopes, "
        "int[] sloped) -> (Tensor, Tensor)");
    m.def(
        "interpolate_backward(Tensor attributes, Tensor raster, Tensor triangles, Tensor? slopes, "
        "int[] sloped, Tensor value_gradient, Tensor value_slope_gradient, "
        "bool attributes_wanted) -> (Tensor, Tensor, Tensor)");
    m.def(
        "texture(Tensor texture, Tensor[] mips, Tensor uv, Tensor? slopes, Tensor? bias, "
        "int filter, int boundary) -> Tensor");
    m.def(
        "texture_backward(Tensor texture, Tensor[] mips, Tensor uv, Tensor? slopes, Tensor? bias, "
        "int filter, int boundary, Tensor gradient, bool texels_wanted, bool others_wanted) "
        "-> (Tensor, Tensor, Tensor, Tensor)");
    m.def("halve(Tensor texture) -> Tensor");
    m.def("halve_backward(Tensor gradient) -> Tensor");
    m.def("add_halve_backward(Tensor gradient, Tensor(a!) finer) -> ()");
    m.def("neighbours(Tensor triangles, Tensor? positions) -> Tensor");
    m.def(
        "antialias(Tensor image, Tensor raster, Tensor positions, Tensor triangles, "
        "Tensor neighbours, int max_steps, bool bottom_up) -> Tensor");
    m.def(
        "antialias_backward(Tensor image, Tensor raster, Tensor positions, Tensor triangles, "
        "Tensor neighbours, Tensor gradient, int max_steps, bool bottom_up, "
        "bool positions_wanted) -> (Tensor, Tensor)");
    m.def("equirectangular(Tensor map, int size) -> Tensor");
    m.def("equirectangular_backward(Tensor gradient, int height, int width) -> Tensor");
    m.def("prefilter(Tensor cube) -> (Tensor[], Tensor[], Tensor, Tensor)");
    m.def(
        "prefilter_backward(Tensor[] gradients, Tensor[] weights, Tensor bright, int size) "
        "-> Tensor");
    m.def(
        "shade(Tensor base_color, Tensor orm, Tensor? normal_map, Tensor normal, Tensor? tangent, "
        "Tensor view, Tensor diffuse, Tensor[] specular, Tensor roughness, "
        "bool multiple_scattering) -> Tensor");
    m.def(
        "shade_backward(Tensor base_color, Tensor orm, Tensor? normal_map, Tensor normal, "
        "Tensor? tangent, Tensor view, Tensor diffuse, Tensor[] specular, Tensor roughness, "
        "bool multiple_scattering, Tensor gradient, bool points_wanted, bool light_wanted) "
        "-> (Tensor, Tensor, Tensor, Tensor, Tensor)");
    m.def("srgb_to_linear(Tensor encoded) -> Tensor");
    m.def("srgb_to_linear_backward(Tensor encoded, Tensor gradient) -> Tensor");
    m.def("linear_to_srgb(Tensor linear) -> Tensor");
    m.def("linear_to_srgb_backward(Tensor linear, Tensor gradient) -> Tensor");
    m.def("tangents(Tensor positions, Tensor normals, Tensor uvs, Tensor triangles) -> Tensor");
}

// The same functions serve the CPU and CUDA devices: an Operation finds the place of its tensors.
#define ITEM3D_OPERATOR_IMPLEMENTATIONS(m)                                                    \
    m.impl("rasterize", TORCH_BOX(&item3d::python::rasterize));                               \
    m.impl("rasterize_backward", TORCH_BOX(&item3d::python::rasterize_backward));             \
    m.impl("interpolate", TORCH_BOX(&item3d::python::interpolate));                           \
    m.impl("interpolate_backward", TORCH_BOX(&item3d::python::interpolate_backward));         \
    m.impl("texture", TORCH_BOX(&item3d::python::texture));                                   \
    m.impl("texture_backward", TORCH_BOX(&item3d::python::texture_backward));                 \
    m.impl("halve", TORCH_BOX(&item3d::python::halve));                                       \
    m.impl("halve_backward", TORCH_BOX(&item3d::python::halve_backward));                     \
    m.impl("add_halve_backward", TORCH_BOX(&item3d::python::add_halve_backward));             \
    m.impl("neighbours", TORCH_BOX(&item3d::python::neighbours));                             \
    m.impl("antialias", TORCH_BOX(&item3d::python::antialias));                               \
    m.impl("antialias_backward", TORCH_BOX(&item3d::python::antialias_backward));             \
    m.impl("equirectangular", TORCH_BOX(&item3d::python::equirectangular));                   \
    m.impl("equirectangular_backward", TORCH_BOX(&item3d::python::equirectangular_backward)); \
    m.impl("prefilter", TORCH_BOX(&item3d::python::prefilter));                               \
    m.impl("prefilter_backward", TORCH_BOX(&item3d::python::prefilter_backward));             \
    m.impl("shade", TORCH_BOX(&item3d::python::shade));                                       \
    m.impl("shade_backward", TORCH_BOX(&item3d::python::shade_backward));                     \
    m.impl("srgb_to_linear", TORCH_BOX(&item3d::python::srgb_to_linear));                     \
    m.impl("srgb_to_linear_backward", TORCH_BOX(&item3d::python::srgb_to_linear_backward));   \
    m.impl("linear_to_srgb", TORCH_BOX(&item3d::python::linear_to_srgb));                     \
    m.impl("linear_to_srgb_backward", TORCH_BOX(&item3d::python::linear_to_srgb_backward));   \
    m.impl("tangents", TORCH_BOX(&item3d::python::tangents));

STABLE_TORCH_LIBRARY_IMPL(item3d, CPU, m){ITEM3D_OPERATOR_IMPLEMENTATIONS(m)}

STABLE_TORCH_LIBRARY_IMPL(item3d, CUDA, m) {
    ITEM3D_OPERATOR_IMPLEMENTATIONS(m)
}
