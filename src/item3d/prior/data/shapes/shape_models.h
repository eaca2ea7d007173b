// Procedural objects as models, and the lookup of a shape class in a sentence.
#pragma once

#include "item3d/scene/model.h"

#include <optional>
#include <string>

namespace item3d {

/// Returns the shape of make_shape() as triangles in the unit sphere, y up. The model has one
/// default material and no UVs.
Model shape_model(const std::string& shape_class, int variant);

/// Returns the shape class (shapes.h) of the sentence's first noun that names one: "chair" in "a
/// wooden chair with a red seat".
std::optional<std::string> shape_named(const std::string& sentence);

}  // namespace item3d
