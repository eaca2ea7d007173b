// A layer made anew for another size of textures or another UV map, from the field that it holds.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

namespace item3d {

/// The layer that the same edit would have left had it been made of this model: its change of the
/// field baked into the model's own textures and UV maps, as the edit baked it, in the region that
/// it was of. texture_size: longest edge; 0: as the edit's settings say. Materials are found by
/// their names. At the size and the UV map of the edit, it is its own layer but for the rounding
/// of the field to half precision. Notes what was made. Throws InputError where the shape lies
/// elsewhere, where a material is not there, for a layer of an older version, and for a region that
/// cannot be found on another UV map.
EditLayer rebake_layer(const EditLayer& layer, const Model& model, int texture_size);

}  // namespace item3d
