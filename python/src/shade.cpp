#include "python/src/shade.h"

#include "item3d/render/kernels/bsdf.h"
#include "item3d/render/kernels/shade.h"
#include "item3d/render/prefilter/specular_chain.h"

#include <algorithm>
#include <iterator>

namespace item3d::python {
namespace {

using kernels::LightGradient;
using kernels::ShadeParameters;

constexpr float bsdf_table[] = {
#include "bsdf_table_values.inc"
};
static_assert(std::size(bsdf_table) == 2 * kernels::bsdf_table_size * kernels::bsdf_table_size);

/// Tensors that the forward and the backward pass share, and the kernels' parameters for them.
struct Inputs {
    Tensor base_color, orm, normal_map, normal, tangent, view, diffuse, roughness;
    std::vector<Tensor> specular;
    std::int64_t count, light_elements;
    ShadeParameters p{};

    Inputs(const char* operation, const ShadeInput& in)
        : base_color(points(operation, "base_color", in.base_color, {-1, 3})),
          diffuse(cube(operation, "light.diffuse", in.diffuse)),
          roughness(checked(operation, "light.roughness", in.roughness, ScalarType::Float, {-1})),
          count(base_color.size(0)),
          light_elements(diffuse.numel()) {
        orm = points(operation, "occlusion, roughness and metallic", in.orm, {count, 3});
        normal = points(operation, "normal", in.normal, {count, 3});
        view = points(operation, "view", in.view, {count, 3});
        if (in.normal_map) {
            if (!in.tangent) fail(operation, "normal_map needs a tangent");
            normal_map = points(operation, "normal_map", *in.normal_map, {count, 3});
            tangent = points(operation, "tangent", *in.tangent, {count, 4});
            p.normal_map = floats(normal_map);
            p.tangent = floats(tangent);
        }
        add_levels(operation, in.specular);
        p.base_color = floats(base_color);
        p.orm = floats(orm);
        p.normal = floats(normal);
        p.view = floats(view);
        p.bsdf = bsdf_table;
        p.bsdf_size = kernels::bsdf_table_size;
        p.multiple_scattering = in.multiple_scattering;
        p.diffuse = floats(diffuse);
        p.diffuse_size = static_cast<int>(diffuse.size(1));
    }

    /// True if a point's directions have a length. `interpolate` leaves zeros at pixels of the
    /// background.
    bool seen(std::int64_t i) const {
        const auto has_length = [](Vec3 v) { return glm::dot(v, v) > 0; };
        return has_length(kernels::load3(p.normal + 3 * i)) &&
               has_length(kernels::load3(p.view + 3 * i)) &&
               (p.normal_map == nullptr || has_length(kernels::load3(p.normal_map + 3 * i)));
    }

  private:
    static Tensor points(const char* operation, const char* name, const Tensor& tensor,
                         const Sizes& sizes) {
        Tensor good = checked(operation, name, tensor, ScalarType::Float, sizes);
        check_finite(operation, name, good);
        return good;
    }
    static Tensor cube(const char* operation, const char* name, const Tensor& tensor) {
        Tensor good = checked(operation, name, tensor, ScalarType::Float, {6, -1, -1, 3});
        if (good.size(1) != good.size(2) || good.size(1) < 2)
            fail(operation, std::string(name) + " must have square faces of at least 2 x 2");
        return good;
    }
    void add_levels(const char* operation, const std::vector<Tensor>& levels) {
        const float* values = floats(roughness);
        const std::int64_t found = roughness.numel();
        if (levels.size() < 4 || levels.size() > kernels::max_specular_levels ||
            found != static_cast<std::int64_t>(levels.size()) || !(values[0] > 0) ||
            std::adjacent_find(values, values + found, [](float a, float b) { return !(a < b); }) !=
                values + found)
            fail(operation,
                 "light.specular needs 4 to 16 levels with a roughness each, ascending from above "
                 "0");
        for (const Tensor& level : levels) {
            specular.push_back(cube(operation, "light.specular", level));
            light_elements += level.numel();
        }
        set_specular_chain(p, specular_levels_of(specular, values));
    }
};

Tensor zeros_or_none(bool wanted, std::int64_t count) {
    return wanted ? new_zeros({count, 3}) : new_tensor({0});
}

}  // namespace

Tensor shade(const Tensor& base_color, const Tensor& orm, const std::optional<Tensor>& normal_map,
             const Tensor& normal, const std::optional<Tensor>& tangent, const Tensor& view,
             const Tensor& diffuse, const std::vector<Tensor>& specular, const Tensor& roughness,
             bool multiple_scattering) {
    const Inputs in("shade", {base_color, orm, normal_map, normal, tangent, view, diffuse, specular,
                              roughness, multiple_scattering});
    ShadeParameters p = in.p;
    const Tensor radiance = new_tensor({in.count, 3});
    p.radiance = mutable_floats(radiance);
    parallel_for(
        "shade", in.count,
        [&](std::int64_t i) {
            if (in.seen(i))
                kernels::shade_forward(p, i);
            else
                std::fill_n(p.radiance + 3 * i, 3, 0.0f);
        },
        2048);
    return radiance;
}

std::tuple<Tensor, Tensor, Tensor, Tensor, Tensor> shade_backward(
    const Tensor& base_color, const Tensor& orm, const std::optional<Tensor>& normal_map,
    const Tensor& normal, const std::optional<Tensor>& tangent, const Tensor& view,
    const Tensor& diffuse, const std::vector<Tensor>& specular, const Tensor& roughness,
    bool multiple_scattering, const Tensor& gradient_, bool points_wanted, bool light_wanted) {
    constexpr const char* operation = "shade backward";
    const Inputs in(operation, {base_color, orm, normal_map, normal, tangent, view, diffuse,
                                specular, roughness, multiple_scattering});
    ShadeParameters p = in.p;
    const Tensor gradient =
        checked(operation, "gradient", gradient_, ScalarType::Float, {in.count, 3});
    p.radiance_gradient = floats(gradient);
    const Tensor by_base_color = zeros_or_none(points_wanted, in.count);
    const Tensor by_orm = zeros_or_none(points_wanted, in.count);
    const Tensor by_normal_map = zeros_or_none(points_wanted && normal_map, in.count);
    const Tensor by_normal = zeros_or_none(points_wanted, in.count);
    if (points_wanted) {
        p.base_color_gradient = mutable_floats(by_base_color);
        p.orm_gradient = mutable_floats(by_orm);
        p.normal_map_gradient = normal_map ? mutable_floats(by_normal_map) : nullptr;
        p.normal_gradient = mutable_floats(by_normal);
    }
    const Tensor by_light = light_wanted ? new_zeros({in.light_elements}) : new_tensor({0});
    if (!light_wanted) {
        parallel_for(
            operation, in.count,
            [&](std::int64_t i) {
                if (in.seen(i)) kernels::shade_backward(p, i, LightGradient{});
            },
            1024);
        return {by_base_color, by_orm, by_normal_map, by_normal, by_light};
    }
    LightGradient light;
    light.diffuse = 0;
    std::int64_t first = in.diffuse.numel();
    for (std::size_t level = 0; level < in.specular.size(); ++level) {
        light.specular[level] = first;
        first += in.specular[level].numel();
    }
    sum_pixels(
        in.count, in.light_elements, mutable_floats(by_light),
        [&](std::int64_t i, const Accumulator& sums) {
            if (!in.seen(i)) return;
            LightGradient own = light;
            own.sums = sums;
            kernels::shade_backward(p, i, own);
        },
        large_map_ratio);
    return {by_base_color, by_orm, by_normal_map, by_normal, by_light};
}

}  // namespace item3d::python
