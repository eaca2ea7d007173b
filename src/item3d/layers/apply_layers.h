// The sum of a model's textures and its layers: each layer adds its changes times its strength.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/layers/layer_use.h"
#include "item3d/scene/model.h"

#include <span>

namespace item3d {

/// A layer and its use; `use.layer` is ignored.
struct AppliedLayer {
    EditLayer layer;
    LayerUse use;
};

/// Returns the combined edit of these layers; the codings of its images are not set. Sums are
/// computed in integers, and rounded and clamped once at the end. So a single layer at full
/// strength gives the values of its own edit, and the order of layers does not matter. The result
/// contains only slots and materials that a layer changes; it is empty if all strengths are 0.
/// Applies a layer's MaterialBeginning to materials of `model`. Throws InputError if a layer's
/// textures differ in size from those of the model or of another layer, or if UV maps differ.
ModelEdit apply_layers(std::span<const AppliedLayer> layers, Model& model);

}  // namespace item3d
