#include "python/src/shade.h"

#include "item3d/render/kernels/bsdf.h"
#include "item3d/render/kernels/shade.h"
#include "item3d/render/prefilter/specular_chain.h"
#include "python/src/value_checks.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <mutex>

namespace item3d::python {
namespace {

using Table = cuda::RenderTable;
using kernels::LightGradient;
using kernels::ShadeParameters;

/// Largest side of a light's maps. Indices of texels are 32-bit integers.
constexpr std::int64_t max_map_size = 8192;

constexpr float bsdf_table[] = {
#include "bsdf_table_values.inc"
};
static_assert(std::size(bsdf_table) == 2 * kernels::bsdf_table_size * kernels::bsdf_table_size);

/// Returns the table on the call's device. A device keeps its copy, which is never freed, because
/// PyTorch may end before static objects do.
const float* table_of(const Operation& call, const Tensor& on_device) {
    static std::mutex mutex;
    static auto& tables = *new std::map<std::int32_t, Tensor>();
    const std::lock_guard lock(mutex);
    const std::int32_t device = on_device.get_device_index();
    auto found = tables.find(device);
    if (found == tables.end())
        found =
            tables
                .emplace(device, call.upload(bsdf_table, std::ssize(bsdf_table), ScalarType::Float))
                .first;
    return floats(found->second);
}

/// Tensors that the forward and the backward pass share, and the kernels' parameters for them.
struct Inputs {
    ValueChecks checks;
    Tensor base_color, orm, normal_map, normal, tangent, view, diffuse, roughness;
    std::vector<Tensor> specular;
    std::int64_t count, light_elements;
    ShadeParameters p{};

    Inputs(const Operation& call, Pass pass, const ShadeInput& in)
        : checks(call, pass),
          base_color(points(call, "base_color", in.base_color, {-1, 3})),
          diffuse(cube(call, "light.diffuse", in.diffuse)),
          count(base_color.size(0)),
          light_elements(diffuse.numel()) {
        orm = points(call, "occlusion, roughness and metallic", in.orm, {count, 3});
        normal = points(call, "normal", in.normal, {count, 3});
        view = points(call, "view", in.view, {count, 3});
        if (in.normal_map) {
            if (!in.tangent) call.fail("normal_map needs a tangent");
            normal_map = points(call, "normal_map", *in.normal_map, {count, 3});
            tangent = points(call, "tangent", *in.tangent, {count, 4});
            p.normal_map = floats(normal_map);
            p.tangent = floats(tangent);
        }
        const Operation own("shade", in.roughness);
        roughness =
            own.on_cpu(own.checked("light.roughness", in.roughness, ScalarType::Float, {-1}));
        add_levels(call, in.specular);
        checks.finish();
        p.base_color = floats(base_color);
        p.orm = floats(orm);
        p.normal = floats(normal);
        p.view = floats(view);
        p.bsdf = call.on_device() ? table_of(call, base_color) : bsdf_table;
        p.bsdf_size = kernels::bsdf_table_size;
        p.multiple_scattering = in.multiple_scattering;
        p.diffuse = floats(diffuse);
        p.diffuse_size = static_cast<int>(diffuse.size(1));
    }

  private:
    Tensor points(const Operation& call, const char* name, const Tensor& tensor,
                  const Sizes& sizes) {
        Tensor good = call.checked(name, tensor, ScalarType::Float, sizes);
        checks.finite(name, good);
        return good;
    }
    static Tensor cube(const Operation& call, const char* name, const Tensor& tensor) {
        Tensor good = call.checked(name, tensor, ScalarType::Float, {6, -1, -1, 3});
        if (good.size(1) != good.size(2) || good.size(1) < 2)
            call.fail(std::string(name) + " must have square faces of at least 2 x 2");
        if (good.size(1) > max_map_size)
            call.fail(std::string(name) + " must have faces of at most " +
                      std::to_string(max_map_size) + " texels a side");
        return good;
    }
    void add_levels(const Operation& call, const std::vector<Tensor>& levels) {
        const float* values = floats(roughness);
        const std::int64_t found = roughness.numel();
        if (levels.size() < 4 || levels.size() > kernels::max_specular_levels ||
            found != static_cast<std::int64_t>(levels.size()) || !(values[0] > 0) ||
            std::adjacent_find(values, values + found, [](float a, float b) { return !(a < b); }) !=
                values + found)
            call.fail(
                "light.specular needs 4 to 16 levels with a roughness each, ascending from above "
                "0");
        for (const Tensor& level : levels) {
            specular.push_back(cube(call, "light.specular", level));
            light_elements += level.numel();
        }
        set_specular_chain(p, specular_levels_of(specular, values));
    }
};

}  // namespace

Tensor shade(const Tensor& base_color, const Tensor& orm, const std::optional<Tensor>& normal_map,
             const Tensor& normal, const std::optional<Tensor>& tangent, const Tensor& view,
             const Tensor& diffuse, const std::vector<Tensor>& specular, const Tensor& roughness,
             bool multiple_scattering) {
    const Operation call("shade", base_color);
    const Inputs in(call, Pass::forward,
                    {base_color, orm, normal_map, normal, tangent, view, diffuse, specular,
                     roughness, multiple_scattering});
    ShadeParameters p = in.p;
    const Tensor radiance = call.empty({in.count, 3});
    p.radiance = mutable_floats(radiance);
    call.run<kernels::shade_pixel>(&Table::shade_pixel, p, in.count, 2048);
    return radiance;
}

std::tuple<Tensor, Tensor, Tensor, Tensor, Tensor> shade_backward(
    const Tensor& base_color, const Tensor& orm, const std::optional<Tensor>& normal_map,
    const Tensor& normal, const std::optional<Tensor>& tangent, const Tensor& view,
    const Tensor& diffuse, const std::vector<Tensor>& specular, const Tensor& roughness,
    bool multiple_scattering, const Tensor& gradient_, bool points_wanted, bool light_wanted) {
    const Operation call("shade backward", base_color);
    const Inputs in(call, Pass::backward,
                    {base_color, orm, normal_map, normal, tangent, view, diffuse, specular,
                     roughness, multiple_scattering});
    ShadeParameters p = in.p;
    const Tensor gradient = call.checked("gradient", gradient_, ScalarType::Float, {in.count, 3});
    p.radiance_gradient = floats(gradient);
    const auto zeros = [&](bool wanted) {
        return wanted ? call.zeros({in.count, 3}) : call.empty({0});
    };
    const Tensor by_base_color = zeros(points_wanted), by_orm = zeros(points_wanted);
    const Tensor by_normal_map = zeros(points_wanted && normal_map);
    const Tensor by_normal = zeros(points_wanted);
    if (points_wanted) {
        p.base_color_gradient = mutable_floats(by_base_color);
        p.orm_gradient = mutable_floats(by_orm);
        p.normal_map_gradient = normal_map ? mutable_floats(by_normal_map) : nullptr;
        p.normal_gradient = mutable_floats(by_normal);
    }
    LightGradient light;
    if (light_wanted) {
        light.diffuse = 0;
        std::int64_t first = in.diffuse.numel();
        for (std::size_t level = 0; level < in.specular.size(); ++level) {
            light.specular[level] = first;
            first += in.specular[level].numel();
        }
    }
    const auto visit = [&](std::int64_t i, const Accumulator& sums) {
        LightGradient own = light;
        own.sums = sums;
        kernels::shade_pixel_backward(p, i, own);
    };
    const auto launch = [&](const Accumulator& sums) {
        LightGradient own = light;
        own.sums = sums;
        call.launch(&Table::shade_pixel_backward, {p, own}, in.count);
    };
    if (light_wanted)
        return {by_base_color, by_orm, by_normal_map, by_normal,
                call.sum(in.count, {in.light_elements}, visit, launch, large_map_ratio)};
    call.visit(in.count, visit, launch, 1024);
    return {by_base_color, by_orm, by_normal_map, by_normal, call.empty({0})};
}

}  // namespace item3d::python
