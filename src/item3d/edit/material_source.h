// Which surface points the edit changes, and what they are made of.
#pragma once

#include "item3d/edit/settings.h"
#include "item3d/field/neural_texture.h"
#include "item3d/field/surface_points.h"
#include "item3d/render/textured_materials.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Material channels that an edit may change or keep.
struct ChannelMask {
    bool base_color = true;
    bool occlusion = true;
    bool roughness = true;
    bool metallic = true;
    bool normal = true;
    bool any() const { return base_color || occlusion || roughness || metallic || normal; }
};
/// What the settings say to edit: all but `keep`, and metallic only as its own setting allows.
ChannelMask edited_channels(const EditSettings& settings);

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

}  // namespace item3d
