// Repair of vertex attributes with numbers that are not finite. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

#include <string>
#include <vector>

namespace item3d {

/// Replaces the elements of float32 vertex attributes that have a number that is not finite, in the
/// document's buffers, so that an edited copy of the document has none. The new elements are 1 in
/// colours and 0 elsewhere. Positions stay as they are, because no position is a good guess, and so
/// do compressed data. Skips accessors that cannot be read. Returns a warning for each attribute
/// that had such numbers.
std::vector<std::string> replace_not_finite(SourceDocument& document);

}  // namespace item3d
