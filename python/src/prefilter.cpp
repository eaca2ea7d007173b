#include "python/src/prefilter.h"

#include "item3d/render/kernels/equirectangular.h"
#include "item3d/render/prefilter/host_backend.h"
#include "item3d/render/prefilter/prefilter_chain.h"

#include <algorithm>

namespace item3d::python {
namespace {

/// Checks a cube's size and returns it.
int cube_size(const char* operation, std::int64_t rows, std::int64_t columns) {
    if (rows != columns || !can_prefilter(rows))
        fail(operation,
             "a cube must have square faces of a power of two in [16, 1024] texels, "
             "found " +
                 std::to_string(rows) + " x " + std::to_string(columns));
    return static_cast<int>(rows);
}

/// True if all values are 0. A map whose gradient is 0 adds nothing to the cube's gradient.
bool is_zero(const Tensor& tensor) {
    const float* values = floats(tensor);
    return std::all_of(values, values + tensor.numel(), [](float value) { return value == 0; });
}

}  // namespace

Tensor equirectangular(const Tensor& map_, std::int64_t size) {
    constexpr const char* operation = "prefilter";
    const Tensor map = checked(operation, "environment", map_, ScalarType::Float, {-1, -1, 3});
    if (map.numel() == 0) fail(operation, "environment must have texels");
    check_finite(operation, "environment", map);
    kernels::EquirectangularParameters p = kernels::equirectangular_parameters(
        static_cast<int>(map.size(0)), static_cast<int>(map.size(1)), static_cast<int>(size));
    const Tensor cube = new_tensor({6, size, size, 3});
    p.map = floats(map);
    p.cube = mutable_floats(cube);
    parallel_for("equirectangular", 6 * size * size,
                 [&](std::int64_t i) { kernels::equirectangular_forward(p, i); });
    return cube;
}

Tensor equirectangular_backward(const Tensor& gradient_, std::int64_t height, std::int64_t width) {
    constexpr const char* operation = "prefilter backward";
    const Tensor gradient =
        checked(operation, "gradient", gradient_, ScalarType::Float, {6, -1, -1, 3});
    const std::int64_t size = gradient.size(1);
    kernels::EquirectangularParameters p = kernels::equirectangular_parameters(
        static_cast<int>(height), static_cast<int>(width), static_cast<int>(size));
    p.cube_gradient = floats(gradient);
    const Tensor by_map = new_zeros({height, width, 3});
    sum_pixels(
        6 * size * size, by_map.numel(), mutable_floats(by_map),
        [&](std::int64_t i, const Accumulator& sums) {
            kernels::EquirectangularParameters own = p;
            own.map_gradient = sums;
            kernels::equirectangular_backward(own, i);
        },
        large_map_ratio);
    return by_map;
}

std::tuple<std::vector<Tensor>, std::vector<Tensor>, Tensor, Tensor> prefilter(
    const Tensor& cube_) {
    constexpr const char* operation = "prefilter";
    const Tensor cube = checked(operation, "environment", cube_, ScalarType::Float, {6, -1, -1, 3});
    const int size = cube_size(operation, cube.size(1), cube.size(2));
    check_finite(operation, "environment", cube);
    const ChainPlan plan = plan_chain(size);
    std::vector<Tensor> maps, weights;
    std::vector<MeanMap> means;
    const auto add_map = [&](int edge) {
        maps.push_back(new_tensor({6, edge, edge, 3}));
        weights.push_back(new_tensor({edge, edge}));
        means.push_back({edge, mutable_floats(maps.back()), mutable_floats(weights.back())});
    };
    const auto levels = static_cast<std::int64_t>(plan.lobes.size());
    const Tensor roughness = new_tensor({levels});
    add_map(irradiance_size);
    for (std::size_t lobe = 0; lobe < plan.lobes.size(); ++lobe) {
        add_map(plan.lobe_size(lobe));
        mutable_floats(roughness)[lobe] = plan.lobes[lobe].roughness;
    }
    const Tensor bright = new_tensor({max_bright}, ScalarType::Long);
    prefilter_forward(HostBackend(), plan, CubeMap::contiguous(floats(cube), size), means,
                      static_cast<std::int64_t*>(bright.mutable_data_ptr()));
    return {maps, weights, roughness, bright};
}

Tensor prefilter_backward(const std::vector<Tensor>& gradients, const std::vector<Tensor>& weights,
                          const Tensor& bright, std::int64_t size_) {
    constexpr const char* operation = "prefilter backward";
    const int size = cube_size(operation, size_, size_);
    const ChainPlan plan = plan_chain(size);
    if (gradients.size() != plan.lobes.size() + 1 || weights.size() != gradients.size())
        fail(operation, "as many gradients and weights as maps");
    std::vector<Tensor> held;
    std::vector<MeanGradient> means;
    const auto hold = [&](const char* name, const Tensor& tensor, const Sizes& sizes) {
        held.push_back(checked(operation, name, tensor, ScalarType::Float, sizes));
        return floats(held.back());
    };
    for (std::size_t i = 0; i < gradients.size(); ++i) {
        const int edge = i == 0 ? irradiance_size : plan.lobe_size(i - 1);
        const float* weight = hold("weights", weights[i], {edge, edge});
        const float* gradient = hold("gradient", gradients[i], {6, edge, edge, 3});
        means.push_back(
            {CubeMap::contiguous(is_zero(held.back()) ? nullptr : gradient, edge), weight});
    }
    if (bright.scalar_type() != ScalarType::Long || bright.numel() != max_bright ||
        !bright.is_contiguous())
        fail(operation, "the bright texels of the forward pass");
    const Tensor by_cube = new_tensor({6, size, size, 3});
    prefilter_backward(HostBackend(), plan, means,
                       static_cast<const std::int64_t*>(bright.const_data_ptr()),
                       mutable_floats(by_cube));
    return by_cube;
}

}  // namespace item3d::python
