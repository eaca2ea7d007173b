#include "python/src/prefilter.h"

#include "item3d/render/kernels/equirectangular.h"
#include "item3d/render/prefilter/host_backend.h"
#include "item3d/render/prefilter/prefilter_chain.h"
#include "python/src/device_backend.h"
#include "python/src/value_checks.h"

#include <algorithm>
#include <memory>

namespace item3d::python {
namespace {

using Table = cuda::RenderTable;

void check_finite(const Operation& call, const Tensor& environment) {
    ValueChecks checks(call, Pass::forward);
    checks.finite("environment", environment);
    checks.finish();
}

/// Checks a cube's size and returns it.
int cube_size(const Operation& call, std::int64_t rows, std::int64_t columns) {
    if (rows != columns || !can_prefilter(rows))
        call.fail(
            "a cube must have square faces of a power of two in [16, 1024] texels, "
            "found " +
            std::to_string(rows) + " x " + std::to_string(columns));
    return static_cast<int>(rows);
}

/// True if the CPU can see that all values are 0. A map whose gradient is 0 adds nothing to the
/// cube's gradient.
bool is_zero(const Operation& call, const Tensor& tensor) {
    const float* values = floats(tensor);
    return !call.on_device() &&
           std::all_of(values, values + tensor.numel(), [](float value) { return value == 0; });
}

std::unique_ptr<PrefilterBackend> backend_of(const Operation& call) {
    if (call.on_device()) return std::make_unique<DeviceBackend>(call);
    return std::make_unique<HostBackend>();
}

}  // namespace

Tensor equirectangular(const Tensor& map_, std::int64_t size) {
    const Operation call("prefilter", map_);
    const Tensor map = call.checked("environment", map_, ScalarType::Float, {-1, -1, 3});
    if (map.numel() == 0) call.fail("environment must have texels");
    check_finite(call, map);
    kernels::EquirectangularParameters p = kernels::equirectangular_parameters(
        static_cast<int>(map.size(0)), static_cast<int>(map.size(1)), static_cast<int>(size));
    const Tensor cube = call.empty({6, size, size, 3});
    p.map = floats(map);
    p.cube = mutable_floats(cube);
    call.run<kernels::equirectangular_forward>(&Table::equirectangular, p, 6 * size * size, 256);
    return cube;
}

Tensor equirectangular_backward(const Tensor& gradient_, std::int64_t height, std::int64_t width) {
    const Operation call("prefilter backward", gradient_);
    const Tensor gradient = call.checked("gradient", gradient_, ScalarType::Float, {6, -1, -1, 3});
    const std::int64_t size = gradient.size(1), count = 6 * size * size;
    kernels::EquirectangularParameters p = kernels::equirectangular_parameters(
        static_cast<int>(height), static_cast<int>(width), static_cast<int>(size));
    p.cube_gradient = floats(gradient);
    const auto with_sums = [&](const Accumulator& sums) {
        kernels::EquirectangularParameters own = p;
        own.map_gradient = sums;
        return own;
    };
    return call.sum(
        count, {height, width, 3},
        [&](std::int64_t i, const Accumulator& sums) {
            kernels::equirectangular_backward(with_sums(sums), i);
        },
        [&](const Accumulator& sums) {
            call.launch(&Table::equirectangular_backward, with_sums(sums), count);
        },
        large_map_ratio);
}

std::tuple<std::vector<Tensor>, std::vector<Tensor>, Tensor, Tensor> prefilter(
    const Tensor& cube_) {
    const Operation call("prefilter", cube_);
    const Tensor cube = call.checked("environment", cube_, ScalarType::Float, {6, -1, -1, 3});
    const int size = cube_size(call, cube.size(1), cube.size(2));
    check_finite(call, cube);
    const ChainPlan plan = plan_chain(size);
    std::vector<Tensor> maps, weights;
    std::vector<MeanMap> means;
    const auto add_map = [&](int edge) {
        maps.push_back(call.empty({6, edge, edge, 3}));
        weights.push_back(call.empty({edge, edge}));
        means.push_back({edge, mutable_floats(maps.back()), mutable_floats(weights.back())});
    };
    const Tensor roughness =
        torch::stable::empty({static_cast<std::int64_t>(plan.lobes.size())}, ScalarType::Float);
    add_map(irradiance_size);
    for (std::size_t lobe = 0; lobe < plan.lobes.size(); ++lobe) {
        add_map(plan.lobe_size(lobe));
        mutable_floats(roughness)[lobe] = plan.lobes[lobe].roughness;
    }
    const Tensor bright = call.empty({max_bright}, ScalarType::Long);
    prefilter_forward(*backend_of(call), plan, CubeMap::contiguous(floats(cube), size), means,
                      static_cast<std::int64_t*>(bright.mutable_data_ptr()));
    return {maps, weights, roughness, bright};
}

Tensor prefilter_backward(const std::vector<Tensor>& gradients, const std::vector<Tensor>& weights,
                          const Tensor& bright, std::int64_t size_) {
    const Operation call("prefilter backward", bright);
    const int size = cube_size(call, size_, size_);
    const ChainPlan plan = plan_chain(size);
    if (gradients.size() != plan.lobes.size() + 1 || weights.size() != gradients.size())
        call.fail("as many gradients and weights as maps");
    std::vector<Tensor> held;
    std::vector<MeanGradient> means;
    const auto hold = [&](const char* name, const Tensor& tensor, const Sizes& sizes) {
        held.push_back(call.checked(name, tensor, ScalarType::Float, sizes));
        return floats(held.back());
    };
    for (std::size_t i = 0; i < gradients.size(); ++i) {
        const int edge = i == 0 ? irradiance_size : plan.lobe_size(i - 1);
        const float* weight = hold("weights", weights[i], {edge, edge});
        const float* gradient = hold("gradient", gradients[i], {6, edge, edge, 3});
        means.push_back(
            {CubeMap::contiguous(is_zero(call, held.back()) ? nullptr : gradient, edge), weight});
    }
    if (bright.scalar_type() != ScalarType::Long || bright.numel() != max_bright ||
        !bright.is_contiguous())
        call.fail("the bright texels of the forward pass");
    const Tensor by_cube = call.empty({6, size, size, 3});
    prefilter_backward(*backend_of(call), plan, means,
                       static_cast<const std::int64_t*>(bright.const_data_ptr()),
                       mutable_floats(by_cube));
    return by_cube;
}

}  // namespace item3d::python
