// Conversion of equirectangular maps to cubes (kernels/equirectangular.h), and their rotation and
// exposure.
//
//     adjusted[y, x] = 2^exposure ((1 - w) map[y, floor(q)] + w map[y, floor(q) + 1])
//     q = x - degrees W / 360        w = q - floor(q)        columns modulo W
//
// The resampling's gradient adds each sample's share to four texels of the map. The CPU does this
// in pieces that do not depend on threads (scatter_sum.h), and a device uses accumulators.
//
//     map  [H, W, 3]        cube  [6, S, S, 3]
#include "item3d/render/prefilter/equirectangular.h"

#include "item3d/core/error.h"
#include "item3d/render/checks.h"
#include "item3d/render/dispatch.h"
#include "item3d/render/kernels/equirectangular.h"
#include "item3d/render/scatter_sum.h"

#include <torch/csrc/autograd/custom_function.h>

namespace item3d {
namespace {

using kernels::EquirectangularParameters;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// Maps [H, W, 3] to [6, S, S, 3].
struct EquirectangularToCube : torch::autograd::Function<EquirectangularToCube> {
    static EquirectangularParameters parameters(std::int64_t height, std::int64_t width, int size) {
        return kernels::equirectangular_parameters(static_cast<int>(height),
                                                   static_cast<int>(width), size);
    }
    static at::Tensor forward(AutogradContext* context, const at::Tensor& map, std::int64_t size) {
        EquirectangularParameters p = parameters(map.size(0), map.size(1), static_cast<int>(size));
        p.map = map.const_data_ptr<float>();
        at::Tensor cube = at::empty({6, size, size, 3}, map.options());
        p.cube = cube.data_ptr<float>();
        dispatch<kernels::equirectangular_forward>(cube.device(), "equirectangular_to_cube",
                                                   &cuda::RenderTable::equirectangular, p,
                                                   6 * size * size);
        context->saved_data["height"] = map.size(0);
        context->saved_data["width"] = map.size(1);
        return cube;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const std::int64_t height = context->saved_data["height"].toInt();
        const std::int64_t width = context->saved_data["width"].toInt();
        const at::Tensor gradient = gradients[0].contiguous();
        const std::int64_t size = gradient.size(1);
        EquirectangularParameters p = parameters(height, width, static_cast<int>(size));
        p.cube_gradient = gradient.const_data_ptr<float>();
        const std::int64_t texels = 6 * size * size, elements = 3 * height * width;
        at::Tensor map_gradient;
        if (gradient.is_cuda())
            map_gradient =
                cuda::sum_on_device(elements, 4 * p.samples * p.samples * texels, gradient.device(),
                                    [&](const Accumulator& sums) {
                                        p.map_gradient = sums;
                                        cuda::run(cuda::render_table().equirectangular_backward, p,
                                                  texels, gradient.device());
                                    });
        else
            map_gradient = scatter_sum("equirectangular_to_cube backward", texels, elements,
                                       [=](std::int64_t i, float* buffer) {
                                           EquirectangularParameters own = p;
                                           own.map_gradient.values = buffer;
                                           kernels::equirectangular_backward(own, i);
                                       });
        return {map_gradient.reshape({height, width, 3}), at::Tensor()};
    }
};

}  // namespace

at::Tensor equirectangular_to_cube(const at::Tensor& equirectangular, int size) {
    at::Tensor map =
        checked("equirectangular_to_cube", "equirectangular", equirectangular, at::kFloat,
                {-1, -1, 3}, operation_device("equirectangular_to_cube", equirectangular));
    ITEM3D_CHECK(size >= 1 && size <= 4096 && map.size(0) >= 1 && map.size(1) >= 1,
                 "equirectangular_to_cube: size in [1, 4096], found " + std::to_string(size));
    // A map much finer than the cube is halved first, which costs less than more samples for each
    // texel.
    while (map.size(0) > 4 * size && map.size(0) % 2 == 0 && map.size(1) % 2 == 0)
        map = map.reshape({map.size(0) / 2, 2, map.size(1) / 2, 2, 3}).mean({1, 3});
    return EquirectangularToCube::apply(map, static_cast<std::int64_t>(size));
}

at::Tensor adjust_light(const at::Tensor& equirectangular, const at::Tensor& degrees,
                        const at::Tensor& exposure) {
    ITEM3D_CHECK(equirectangular.dim() == 3 && equirectangular.size(1) >= 1,
                 "adjust_light: equirectangular must be [H, W, C]");
    ITEM3D_CHECK(degrees.numel() == 1 && exposure.numel() == 1,
                 "adjust_light: degrees and exposure are scalars");
    const std::int64_t width = equirectangular.size(1);
    const at::Tensor source =
        at::arange(width, equirectangular.options()) - degrees * (width / 360.0);
    const at::Tensor floor = source.detach().floor();
    const at::Tensor left = at::remainder(floor, width).to(at::kLong);
    const at::Tensor right = at::remainder(floor + 1, width).to(at::kLong);
    const at::Tensor weight = (source - floor).view({1, width, 1});
    const at::Tensor turned = (1 - weight) * equirectangular.index_select(1, left) +
                              weight * equirectangular.index_select(1, right);
    return turned * at::exp2(exposure);
}

}  // namespace item3d
