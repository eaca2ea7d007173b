// The procedural objects as models, and which of them a sentence talks of.
#pragma once

#include "item3d/scene/model.h"

#include <optional>
#include <string>

namespace item3d {

/// make_shape(), polygonised, in the unit sphere, y up, with one default material and no UVs.
Model shape_model(const std::string& shape_class, int variant);

/// The class (shapes.h) of the first word that captions use for one: "chair" of "a wooden chair
/// with a red seat".
std::optional<std::string> shape_named(const std::string& sentence);

}  // namespace item3d
