// A new bake of a layer from its field, for another texture size or another UV map.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Returns the layer that the same edit would have produced on this model. The edit's change of the
/// field is baked into the model's own textures and UV maps, with the edit's bake options and
/// region. Materials are matched by name. With the edit's size and UV map the result equals the
/// edit's layer, except that the field was rounded to half precision. Prints a note of the result.
/// texture_size: longest edge of the textures; 0: as in the edit's settings. Throws InputError if
/// the edited surface has another position or size, if a material is missing, if the layer is of an
/// older version, or if the region cannot be found on another UV map.
EditLayer rebake_layer(const EditLayer& layer, const Model& model, int texture_size);

}  // namespace item3d
