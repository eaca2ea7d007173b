// Where metallic and roughness begin, by what the sentences say and what the model is made of.
#pragma once

#include "item3d/edit/plan.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/scene/model.h"

#include <optional>
#include <vector>

namespace item3d {

struct MaterialStart {
    /// The plan's, with metallic where the model makes it necessary.
    ChannelMask channels;
    /// Means that the field begins with; none: the model's own.
    std::optional<float> metallic;
    std::optional<float> roughness;  ///< there: the whole becomes a metal
};

/// Whether the metallic and roughness of a material are what nobody chose: glTF's defaults, both 1
/// and without a texture, which exporters leave behind on cloth, skin and paint.
bool has_default_metal(const Material& material);

/// materials: those that are edited.
///  - Towards a metal, metallic begins at `metallic_start`, unless the source is that metallic
///    already, and roughness at the metal's own, unless only a part is of it ("with a golden
///    handle").
///  - Away from metal, and where nobody chose to be metal, metallic begins as far from 1. A model
///    that is metal counts where the target names a material that is none, whatever the source's
///    sentence says.
MaterialStart choose_start(const EditPlan& plan, const PriorVocabulary& vocabulary,
                           const Model& model, const std::vector<int>& materials);

}  // namespace item3d
