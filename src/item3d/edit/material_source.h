// Which surface points the edit changes, and what they are made of.
#pragma once

#include "item3d/core/math.h"
#include "item3d/edit/plan.h"
#include "item3d/field/neural_texture.h"
#include "item3d/field/surface_points.h"
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

/// The neural texture where a material is edited, the model's own textures elsewhere and for the
/// channels that are kept.
class MaterialSource {
  public:
    /// `textured` and `space` must outlive this. device: theirs and that of the surfaces to come.
    MaterialSource(const Model& model, const TexturedMaterials& textured, const FieldSpace& space,
                   const std::vector<int>& edited_materials, ChannelMask channels,
                   at::Device device = at::kCPU);
    /// The model's own materials, which are the same whatever the field holds.
    MaterialSample own(const Surface& surface) const;
    /// Differentiable in the field's parameters. own: of this surface.
    MaterialSample sample(const Surface& surface, NeuralTexture& field,
                          const MaterialSample& own) const;

  private:
    const TexturedMaterials& textured_;
    const FieldSpace& space_;
    at::Tensor is_edited_;  ///< [materials] bool
    bool all_edited_ = true;
    at::Tensor orm_is_edited_;  ///< [3] bool
    ChannelMask channels_;
};

/// Mean values over a surface, by area: what an edit changed, in numbers.
struct SurfaceMeans {
    Vec3 base_color{0.0f};  ///< linear RGB
    float roughness = 0;
    float metallic = 0;
};

/// Means of these materials (indices into Model::materials), at 20,000 points drawn with the seed.
SurfaceMeans surface_means(const Model& model, const std::vector<int>& materials,
                           std::uint64_t seed = 0);

}  // namespace item3d
