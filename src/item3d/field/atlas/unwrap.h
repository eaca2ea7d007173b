// The computation of new UVs by xatlas.
#pragma once

#include "item3d/io/save.h"
#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// Returns new UVs for several primitives, in their order. All share one atlas of size x size
/// texels. The charts lie inside [0, 1], do not overlap, and are a few texels apart. Triangles keep
/// their order and corners. Throws InputError for a mesh that xatlas refuses.
std::vector<PrimitiveEdit> unwrap(const std::vector<const Primitive*>& primitives, int size);

}  // namespace item3d
