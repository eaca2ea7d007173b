// Base colours that were painted into UV space, at the texels of a texture of another size.
#pragma once

#include "item3d/core/math.h"
#include "item3d/field/bake/slot.h"
#include "item3d/scene/image.h"

namespace item3d {

/// The bilinear colour of `painted` (three channels or more) at the middle of texel (x, y) of a
/// texture of `size`, clamped to [0, 1]: where both have one size the texel's own. Beyond the
/// middle of the outermost texels their values go on.
Vec3 color_at_texel(const Image& painted, int x, int y, TextureSize size);

}  // namespace item3d
