// Which surface points the edit changes, and what they are made of.
#pragma once

#include "item3d/core/math.h"
#include "item3d/edit/plan.h"
#include "item3d/field/neural_texture.h"
#include "item3d/field/surface_points.h"
#include "item3d/region/region.h"
#include "item3d/render/textured_materials.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

/// Indices into Model::materials of the named ones (all for an empty list), in rising order.
/// Throws InputError that lists the model's materials when a name is not among them.
std::vector<int> select_materials(const Model& model, const std::vector<std::string>& names);

/// The model's own materials at a surface, the same whatever the field holds.
struct OwnMaterial {
    MaterialSample sample;
    at::Tensor edited;  ///< [P, 1] how much of the edit each point takes; undefined: all
};

/// The neural texture where a material is edited, the model's own textures elsewhere and for the
/// channels that are kept; blended by the weight of the region, where there is one.
class MaterialSource {
  public:
    /// `textured`, `space` and `region` must outlive this. device: theirs and that of the surfaces
    /// to come. region: null for all of the edited materials.
    MaterialSource(const Model& model, const TexturedMaterials& textured, const FieldSpace& space,
                   const std::vector<int>& edited_materials, ChannelMask channels,
                   const Region* region = nullptr, at::Device device = at::kCPU);
    OwnMaterial own(const Surface& surface) const;
    /// Differentiable in the field's parameters. own: of this surface.
    MaterialSample sample(const Surface& surface, NeuralTexture& field,
                          const OwnMaterial& own) const;

  private:
    const TexturedMaterials& textured_;
    const FieldSpace& space_;
    at::Tensor is_edited_;  ///< [materials] bool
    bool all_edited_ = true;
    at::Tensor orm_is_edited_;  ///< [3] bool
    ChannelMask channels_;
    const Region* region_;
};

/// Mean values over a surface, by area: what an edit changed, in numbers.
struct SurfaceMeans {
    Vec3 base_color{0.0f};  ///< linear RGB
    float roughness = 0;
    float metallic = 0;
};

/// Means of these materials (indices into Model::materials), at 20,000 points drawn with the seed.
/// weights: of mean_weights(); undefined: all count alike.
SurfaceMeans surface_means(const Model& model, const std::vector<int>& materials,
                           const at::Tensor& weights = {}, std::uint64_t seed = 0);
/// [20000, 1] weights of a region at the points of surface_means().
at::Tensor mean_weights(const Region& region, const Geometry& geometry, const FieldSpace& space,
                        std::uint64_t seed = 0);

}  // namespace item3d
