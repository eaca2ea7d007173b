#include "item3d/render/shade.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/render/checks.h"
#include "item3d/render/dispatch.h"
#include "item3d/render/kernels/shade.h"
#include "item3d/render/prefilter/bsdf_table.h"
#include "item3d/render/prefilter/specular_chain.h"
#include "item3d/render/scatter_sum.h"

#include <torch/csrc/autograd/custom_function.h>

#include <algorithm>

namespace item3d {
namespace {

using kernels::LightGradient;
using kernels::ShadeParameters;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// Non-differentiable inputs.
struct ShadeSettings {
    at::Tensor tangent, view;
    std::vector<float> roughness;
    bool multiple_scattering;
};

/// Inputs in this order: base_color, orm, normal map ([0, 3]: none), surface normal, diffuse,
/// specular levels.
constexpr std::size_t first_level = 5;

/// Returns the BSDF table, which is cached on the first device that requests it.
at::Tensor bsdf_table_on(at::Device device) {
    if (device.is_cpu()) return bsdf_table();
    static const at::Tensor first = bsdf_table().to(device);
    return first.device() == device ? first : bsdf_table().to(device);
}

/// Returns the kernel's parameters. bsdf: result of bsdf_table_on() for the inputs' device.
ShadeParameters shade_parameters(const tensor_list& inputs, const ShadeSettings& settings,
                                 const at::Tensor& bsdf) {
    const auto pointer = [](const at::Tensor& tensor) {
        return tensor.numel() > 0 ? tensor.const_data_ptr<float>() : nullptr;
    };
    ShadeParameters p{};
    p.base_color = pointer(inputs[0]);
    p.orm = pointer(inputs[1]);
    p.normal_map = pointer(inputs[2]);
    p.normal = pointer(inputs[3]);
    p.tangent = pointer(settings.tangent);
    p.view = pointer(settings.view);
    p.bsdf = pointer(bsdf);
    p.bsdf_size = static_cast<int>(bsdf.size(0));
    p.multiple_scattering = settings.multiple_scattering;
    p.diffuse = pointer(inputs[4]);
    p.diffuse_size = static_cast<int>(inputs[4].size(1));
    const tensor_list levels{inputs.begin() + first_level, inputs.end()};
    set_specular_chain(p, specular_levels_of(levels, settings.roughness.data()));
    return p;
}

/// Returns the light's gradient [light_elements].
at::Tensor shade_backward_on_cuda(const ShadeParameters& p, const LightGradient& light,
                                  std::int64_t light_elements, std::int64_t count,
                                  at::Device device) {
    kernels::ShadeBackwardParameters parameters{p, light};
    const auto launch = [&](const Accumulator& sums) {
        parameters.light.sums = sums;
        cuda::run(cuda::render_table().shade_backward, parameters, count, device);
    };
    if (light_elements > 0) return cuda::sum_on_device(light_elements, 4 * count, device, launch);
    launch({});
    return {};
}

struct Shade : torch::autograd::Function<Shade> {
    static at::Tensor forward(AutogradContext* context, at::TensorList inputs_,
                              const ShadeSettings& settings) {
        const tensor_list inputs = inputs_.vec();
        at::Tensor radiance = at::empty_like(inputs[0]);
        const at::Tensor bsdf = bsdf_table_on(radiance.device());
        ShadeParameters p = shade_parameters(inputs, settings, bsdf);
        p.radiance = radiance.data_ptr<float>();
        dispatch<kernels::shade_forward>(radiance.device(), "shade", &cuda::RenderTable::shade, p,
                                         radiance.size(0), 2048);

        tensor_list saved = inputs;
        saved.push_back(settings.tangent);
        saved.push_back(settings.view);
        context->save_for_backward(saved);
        context->saved_data["roughness"] =
            std::vector<double>(settings.roughness.begin(), settings.roughness.end());
        context->saved_data["multiple_scattering"] = settings.multiple_scattering;
        return radiance;
    }

    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        tensor_list inputs = context->get_saved_variables();
        ShadeSettings settings;
        settings.view = inputs.back();
        inputs.pop_back();
        settings.tangent = inputs.back();
        inputs.pop_back();
        for (const double roughness : context->saved_data["roughness"].toDoubleVector())
            settings.roughness.push_back(static_cast<float>(roughness));
        settings.multiple_scattering = context->saved_data["multiple_scattering"].toBool();

        const at::Tensor radiance_gradient = gradients[0].contiguous();
        const at::Device device = radiance_gradient.device();
        const at::Tensor bsdf = bsdf_table_on(device);
        ShadeParameters p = shade_parameters(inputs, settings, bsdf);
        p.radiance_gradient = radiance_gradient.const_data_ptr<float>();
        tensor_list results(inputs.size() + 1);
        const auto wanted = [&](std::size_t i) -> float* {
            if (inputs[i].numel() == 0 || !context->needs_input_grad(i)) return nullptr;
            results[i] = at::empty_like(inputs[i]);
            return results[i].data_ptr<float>();
        };
        p.base_color_gradient = wanted(0);
        p.orm_gradient = wanted(1);
        p.normal_map_gradient = wanted(2);
        p.normal_gradient = wanted(3);

        const std::int64_t count = radiance_gradient.size(0);
        std::int64_t light_elements = 0;
        std::vector<std::int64_t> offsets(inputs.size(), -1);
        for (std::size_t i = first_level - 1; i < inputs.size(); ++i) {
            if (!context->needs_input_grad(i)) continue;
            offsets[i] = light_elements;
            light_elements += inputs[i].numel();
        }
        LightGradient light;
        light.diffuse = offsets[first_level - 1];
        std::copy(offsets.begin() + first_level, offsets.end(), light.specular);
        at::Tensor light_gradient;
        if (device.is_cuda())
            light_gradient = shade_backward_on_cuda(p, light, light_elements, count, device);
        else if (light_elements > 0)
            light_gradient = scatter_sum("shade backward", count, light_elements,
                                         [&](std::int64_t i, float* buffer) {
                                             LightGradient own = light;
                                             own.sums.values = buffer;
                                             kernels::shade_backward(p, i, own);
                                         });
        else
            parallel_for(
                "shade backward", count,
                [&](std::int64_t i) { kernels::shade_backward(p, i, light); }, 1024);
        for (std::size_t i = first_level - 1; i < inputs.size(); ++i)
            if (offsets[i] >= 0)
                results[i] = light_gradient.narrow(0, offsets[i], inputs[i].numel())
                                 .reshape(inputs[i].sizes());
        return results;
    }
};

}  // namespace

at::Tensor shade(const Surface& surface, const MaterialSample& material,
                 const EnvironmentLight& light, const ShadeOptions& options) {
    constexpr const char* op = "shade";
    constexpr auto real = at::kFloat;
    const at::Device device = operation_device(op, material.base_color);
    const std::int64_t count = surface.count();
    ITEM3D_CHECK(light.specular.size() >= 4 && light.specular.size() == light.roughness.size() &&
                     light.specular.size() <= kernels::max_specular_levels,
                 "shade: light.specular needs 4 to 16 levels with a roughness each, ascending");
    const auto cube = [&](const char* name, const at::Tensor& map) {
        at::Tensor good = checked(op, name, map, real, {6, -1, -1, 3}, device);
        ITEM3D_CHECK(good.size(1) == good.size(2) && good.size(1) >= 2,
                     std::string("shade: ") + name + " must have square faces of at least 2 x 2");
        return good;
    };
    tensor_list inputs{checked(op, "base_color", material.base_color, real, {count, 3}, device),
                       checked(op, "orm", material.orm, real, {count, 3}, device),
                       material.normal.defined()
                           ? checked(op, "normal", material.normal, real, {count, 3}, device)
                           : at::empty({0, 3}, at::TensorOptions().dtype(real).device(device)),
                       checked(op, "surface.normal", surface.normal, real, {count, 3}, device),
                       cube("light.diffuse", light.diffuse)};
    for (const at::Tensor& level : light.specular)
        inputs.push_back(cube("light.specular", level));
    const ShadeSettings settings{
        checked(op, "surface.tangent", surface.tangent.detach(), real, {count, 4}, device),
        checked(op, "surface.view", surface.view.detach(), real, {count, 3}, device),
        light.roughness, options.multiple_scattering};
    at::Tensor radiance = Shade::apply(at::TensorList(inputs), settings);
    if (material.emissive.defined())
        radiance = radiance + checked(op, "emissive", material.emissive, real, {count, 3}, device);
    return radiance;
}

}  // namespace item3d
