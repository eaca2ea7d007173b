// The material properties that contradict an edit: emission that repeats or hides the base colour,
// transmission in an object that becomes gold.
#pragma once

#include "item3d/edit/plan.h"
#include "item3d/io/save.h"
#include "item3d/scene/model.h"

#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Properties of an edited material that the edited file no longer has.
struct MaterialLosses {
    bool emission = false;
    bool transparency = false;
    std::vector<std::string> extensions;  ///< by name
};

/// Prepares the edited materials for the edit, and logs each change. Unlit materials become lit.
/// Emission that repeats the base colour is removed; emission over a black base colour becomes the
/// base colour. Where the target names a metal or another opaque material, removes transmission,
/// and sheen except on cloth. Warns of contradicting properties that remain.
std::map<int, MaterialLosses> prepare_materials(Model& model, const std::vector<int>& materials,
                                                const EditPlan& plan);

/// Marks the lost properties in an edit that is to be saved.
void apply_losses(const std::map<int, MaterialLosses>& losses, ModelEdit& edit);

/// Returns names of the model's variants that show one of these materials, or (with = false) none
/// of them.
std::vector<std::string> variants_with(const Model& model, const std::vector<int>& materials,
                                       bool with);

}  // namespace item3d
