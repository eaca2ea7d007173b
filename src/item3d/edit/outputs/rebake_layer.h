// A layer rebaked from its field for another texture size or another UV map.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Returns the layer that the same edit would have produced on this model: the edit's change of the
/// field, baked into the model's own textures and UV maps, with the edit's bake options and region.
/// texture_size: longest edge; 0: as the edit's settings say. Materials are matched by name. At the
/// edit's size and UV map the result equals the edit's layer up to the rounding of the field to
/// half precision. Logs a note of the result. Throws InputError where the edited surface has
/// another position or size, where a material is missing, for a layer of an older version, and for
/// a region that cannot be found on another UV map.
EditLayer rebake_layer(const EditLayer& layer, const Model& model, int texture_size);

}  // namespace item3d
