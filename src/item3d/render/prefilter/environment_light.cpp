#include "item3d/render/prefilter/environment_light.h"

#include "item3d/core/error.h"
#include "item3d/render/checks.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/prefilter/equirectangular.h"
#include "item3d/render/prefilter/prefilter_chain.h"
#include "item3d/render/prefilter/tensor_backend.h"

#include <torch/csrc/autograd/custom_function.h>

#include <algorithm>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// Returns a view of `map` [6, S, S, 3], which may have any strides.
CubeMap cube_map(const at::Tensor& map) {
    CubeMap view{map.const_data_ptr<float>(), static_cast<int>(map.size(1)), {}};
    std::copy_n(map.strides().begin(), 4, view.step);
    return view;
}

/// Maps a cube [6, S, S, 3] to the irradiance map and one map for each lobe.
struct Prefilter : torch::autograd::Function<Prefilter> {
    static tensor_list forward(AutogradContext* context, const at::Tensor& cube) {
        const ChainPlan plan = plan_chain(static_cast<int>(cube.size(1)));
        tensor_list maps, weights;
        std::vector<MeanMap> means;
        const auto add_map = [&](int size) {
            maps.push_back(at::empty({6, size, size, 3}, cube.options()));
            weights.push_back(at::empty({size, size}, cube.options()));
            means.push_back(
                {size, maps.back().data_ptr<float>(), weights.back().data_ptr<float>()});
        };
        add_map(irradiance_size);
        for (std::size_t lobe = 0; lobe < plan.lobes.size(); ++lobe)
            add_map(plan.lobe_size(lobe));
        const at::Tensor bright = at::empty({max_bright}, cube.options().dtype(at::kLong));
        prefilter_forward(TensorBackend(cube.device()), plan, cube_map(cube), means,
                          bright.data_ptr<std::int64_t>());
        context->set_materialize_grads(false);
        context->saved_data["weights"] = weights;
        context->saved_data["size"] = cube.size(1);
        context->saved_data["bright"] = bright;
        return maps;
    }

    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const std::int64_t size = context->saved_data["size"].toInt();
        const std::vector<at::Tensor> weights = context->saved_data["weights"].toTensorVector();
        std::vector<MeanGradient> means;
        for (std::size_t i = 0; i < weights.size(); ++i)
            means.push_back({gradients[i].defined() ? cube_map(gradients[i]) : CubeMap{},
                             weights[i].const_data_ptr<float>()});
        const at::Tensor by_cube = at::empty({6, size, size, 3}, weights[0].options());
        prefilter_backward(TensorBackend(by_cube.device()), plan_chain(static_cast<int>(size)),
                           means,
                           context->saved_data["bright"].toTensor().const_data_ptr<std::int64_t>(),
                           by_cube.data_ptr<float>());
        return {by_cube};
    }
};

}  // namespace

EnvironmentLight EnvironmentLight::to(at::Device device) const {
    EnvironmentLight moved{diffuse.to(device), {}, roughness};
    for (const at::Tensor& level : specular)
        moved.specular.push_back(level.to(device));
    return moved;
}

EnvironmentLight prefilter(const at::Tensor& cube_) {
    const at::Tensor cube = checked("prefilter", "cube", cube_, at::kFloat, {6, -1, -1, 3},
                                    operation_device("prefilter", cube_));
    const int size = static_cast<int>(cube.size(1));
    ITEM3D_CHECK(cube.size(2) == size && can_prefilter(size),
                 "prefilter: cube must be [6, S, S, 3] with S a power of two in [16, 1024], found "
                 "S = " +
                     std::to_string(size) + " and " + std::to_string(cube.size(2)));

    const tensor_list maps = Prefilter::apply(cube);
    EnvironmentLight light{maps[0], {maps.begin() + 1, maps.end()}, {}};
    for (const Lobe& lobe : plan_chain(size).lobes)
        light.roughness.push_back(lobe.roughness);
    return light;
}

EnvironmentLight prefilter(const Image& equirectangular, int size, at::Device device) {
    const at::NoGradGuard no_gradient;
    at::Tensor pixels = to_tensor(equirectangular);
    ITEM3D_CHECK(pixels.dim() == 3 && pixels.size(2) >= 3, "prefilter: an image of RGB radiance");
    return prefilter(equirectangular_to_cube(pixels.narrow(2, 0, 3).to(device), size));
}

}  // namespace item3d
