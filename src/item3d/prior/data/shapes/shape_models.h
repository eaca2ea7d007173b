// Procedural objects as models, and the lookup of a shape class in a sentence.
#pragma once

#include "item3d/scene/model.h"

#include <optional>
#include <string>

namespace item3d {

/// Returns make_shape(), polygonised, in the unit sphere, y up, with one default material and no
/// UVs.
Model shape_model(const std::string& shape_class, int variant);

/// Returns the shape class (shapes.h) that the first such noun of the sentence names: "chair" in "a
/// wooden chair with a red seat".
std::optional<std::string> shape_named(const std::string& sentence);

}  // namespace item3d
