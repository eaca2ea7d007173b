// Material lookup at surface points during an edit. Where the edit changes the material, the values
// come from the neural texture (the field), elsewhere from the model's own textures.
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

/// Returns the indices in Model::materials of the named materials, in rising order; all indices if
/// `names` is empty. Throws InputError that lists the model's materials if a name is not among
/// them.
std::vector<int> select_materials(const Model& model, const std::vector<std::string>& names);

/// The model's own materials at a surface, independent of the field.
struct OwnMaterial {
    MaterialSample sample;
    /// [P, 1] weight of the edit at each point; undefined if it is 1 everywhere.
    at::Tensor edited;
};

/// Material lookup at surface points. The neural texture supplies the edited channels of edited
/// materials. The model's own textures supply everything else. Where the edit has a region, its
/// weight blends the two.
class MaterialSource {
  public:
    /// textured, space and region must outlive this object. device: the device of these objects,
    /// and of all surfaces passed later. region: null if the edit changes all of the edited
    /// materials.
    MaterialSource(const Model& model, const TexturedMaterials& textured, const FieldSpace& space,
                   const std::vector<int>& edited_materials, ChannelMask channels,
                   const Region* region = nullptr, at::Device device = at::kCPU);
    OwnMaterial own(const Surface& surface) const;
    /// Returns the edited material, differentiable in the field's parameters. own: result of own()
    /// for this surface.
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

/// Area-weighted means of a surface's material. edit.json has them from before and after the edit.
struct SurfaceMeans {
    Vec3 base_color{0.0f};  ///< linear RGB
    float roughness = 0;
    float metallic = 0;
};

/// Returns the means at 20,000 points of these materials (indices in Model::materials). The points
/// are drawn with the seed. weights: from mean_weights(); if undefined, all points count alike.
SurfaceMeans surface_means(const Model& model, const std::vector<int>& materials,
                           const at::Tensor& weights = {}, std::uint64_t seed = 0);
/// Returns a region's weights at the points of surface_means(), [20000, 1].
at::Tensor mean_weights(const Region& region, const Geometry& geometry, const FieldSpace& space,
                        std::uint64_t seed = 0);

}  // namespace item3d
