// The lookup of base colours that were painted in UV space, for a texture of another size.
#pragma once

#include "item3d/core/math.h"
#include "item3d/field/bake/slot.h"
#include "item3d/scene/image.h"

namespace item3d {

/// Returns the colour of `painted` at the centre of texel (x, y) of a texture of `size`, clamped to
/// [0, 1]. painted: has three channels or more. The lookup is bilinear and clamps to the edge; if
/// both sizes are equal, it returns the texel's own colour.
Vec3 color_at_texel(const Image& painted, int x, int y, TextureSize size);

}  // namespace item3d
