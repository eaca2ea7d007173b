// The initial values of metallic and roughness, which depend on the sentences and the model's
// materials.
#pragma once

#include "item3d/edit/plan.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/scene/model.h"

#include <optional>
#include <vector>

namespace item3d {

struct MaterialStart {
    /// The plan's channels, and also metallic if the model requires it.
    ChannelMask channels;
    /// Initial means of the neural texture. Without a value they are the means of the model's
    /// materials.
    std::optional<float> metallic;
    std::optional<float> roughness;  ///< has a value if the whole surface becomes metal
};

/// True if the metallic and roughness of a material are glTF's defaults (both 1, without a
/// texture). Exporters leave these defaults on cloth, skin and paint.
bool has_default_metal(const Material& material);

/// Chooses the initial values. materials: indices of the edited materials.
///  - Target names a metal: metallic starts at `metallic_start`, unless the source names a metal
///    and the model is metallic already. Roughness starts at the metal's own value, unless only a
///    part becomes metal ("with a golden handle").
///  - Target names no metal: metallic starts at 1 - `metallic_start` where the source names a
///    metal, where all edited materials have glTF's defaults, or where the target names a
///    non-metal and the model is metallic.
MaterialStart choose_start(const EditPlan& plan, const PriorVocabulary& vocabulary,
                           const Model& model, const std::vector<int>& materials);

}  // namespace item3d
