#include "item3d/edit/outputs/surface_means.h"

#include "item3d/field/surface_points.h"
#include "item3d/render/textured_materials.h"

namespace item3d {

SurfaceMeans surface_means(const Model& model, const std::vector<int>& materials,
                           std::uint64_t seed) {
    const at::NoGradGuard no_grad;
    const Geometry geometry = Geometry::from_model(model);
    const FieldSpace space(model, materials);
    const SurfaceSampler sampler(geometry, space);
    Random random(seed);
    const MaterialSample sample = TexturedMaterials(model).sample(sampler.sample(20000, random));
    const at::Tensor color = sample.base_color.mean(0).contiguous();
    const at::Tensor orm = sample.orm.mean(0).contiguous();
    const float* rgb = color.data_ptr<float>();
    const float* values = orm.data_ptr<float>();
    return {Vec3(rgb[0], rgb[1], rgb[2]), values[1], values[2]};
}

}  // namespace item3d
