// Layers on a model's textures: the model's + the sum of strengths times what the edits changed.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/layers/layer_use.h"
#include "item3d/scene/model.h"

#include <span>

namespace item3d {

/// A layer and how it is applied; `use.layer` may be anything.
struct AppliedLayer {
    EditLayer layer;
    LayerUse use;
};

/// The edit that these layers make of the model together, without codings. Sums are of integers,
/// rounded and clamped once at the end: a layer alone at full strength gives the values of its own
/// edit, and the order of layers is no matter. Slots and materials that no layer changes are not in
/// it; it is empty where all strengths are 0. Materials that an edit began from in another way than
/// the file's become so in `model`. Throws InputError where a layer's textures have other sizes
/// than the model's or another layer's, or UV maps differ.
ModelEdit apply_layers(std::span<const AppliedLayer> layers, Model& model);

}  // namespace item3d
