// The material properties that contradict an edit, such as emission that repeats or hides the base
// colour, or transmission in an object that becomes gold.
#pragma once

#include "item3d/edit/plan.h"
#include "item3d/io/save.h"
#include "item3d/scene/model.h"

#include <map>
#include <string>
#include <vector>

namespace item3d {

/// The properties that an edited material no longer has in the edited file.
struct MaterialLosses {
    bool emission = false;
    bool transparency = false;
    std::vector<std::string> extensions;  ///< names of the extensions
};

/// Prepares the edited materials for the edit, and prints a note of each change. Unlit materials
/// become lit. Emission that repeats the base colour is removed. Emission over a black base colour
/// becomes the base colour. If the target names a metal or another opaque material, transmission is
/// removed, and so is sheen, except on cloth. Warns of contradicting properties that remain.
std::map<int, MaterialLosses> prepare_materials(Model& model, const std::vector<int>& materials,
                                                const EditPlan& plan);

/// Marks the lost properties in an edit that is to be saved.
void apply_losses(const std::map<int, MaterialLosses>& losses, ModelEdit& edit);

/// Returns the names of the model's variants that show one of these materials. If `with` is false,
/// returns the names of the variants that show none of them.
std::vector<std::string> variants_with(const Model& model, const std::vector<int>& materials,
                                       bool with);

}  // namespace item3d
