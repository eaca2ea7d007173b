// Pictures as parts of a page.
#pragma once

#include "item3d/core/files.h"

#include <string>

namespace item3d {

/// "data:image/png;base64,..." of an encoded picture (PNG, JPEG, WebP, GIF; told by its first
/// bytes).
std::string data_uri(const Bytes& bytes);

}  // namespace item3d
