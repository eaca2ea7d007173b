// Properties of a model's materials that contradict an edit: emission that repeats or hides the
// base colour, glass that is to become gold.
#pragma once

#include "item3d/edit/plan.h"
#include "item3d/io/save.h"
#include "item3d/scene/model.h"

#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Properties that an edited material loses in the file besides its textures.
struct MaterialLosses {
    bool emission = false;
    bool transparency = false;
    std::vector<std::string> extensions;  ///< by name
};

/// Makes the edited materials what the edit begins from, a surface in light whose look is its base
/// colour, and says so: unlit ones, and such that show by emission what others have as base colour.
/// Where the target names a metal or another opaque material, what lets light through goes, and
/// sheen with all but cloth. What stays and is not edited is a warning.
std::map<int, MaterialLosses> prepare_materials(Model& model, const std::vector<int>& materials,
                                                const EditPlan& plan);

/// Into an edit that is to be saved.
void apply_losses(const std::map<int, MaterialLosses>& losses, ModelEdit& edit);

/// Names of the model's variants that show one of these materials, or none of them.
std::vector<std::string> variants_with(const Model& model, const std::vector<int>& materials,
                                       bool with);

}  // namespace item3d
