// The computation of new UVs by xatlas.
#pragma once

#include "item3d/io/save.h"
#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// Returns one atlas for several primitives, in their order: no overlaps, inside [0, 1], charts a
/// few texels apart in an image of size x size. Triangles keep their order and corners. Throws
/// InputError for a mesh that xatlas refuses.
std::vector<PrimitiveEdit> unwrap(const std::vector<const Primitive*>& primitives, int size);

}  // namespace item3d
