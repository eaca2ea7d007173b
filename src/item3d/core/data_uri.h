// Data URIs, which embed images in an HTML page.
#pragma once

#include "item3d/core/files.h"

#include <string>

namespace item3d {

/// Returns "data:image/png;base64,..." of an encoded image (PNG, JPEG, WebP, GIF; detected by its
/// first bytes).
std::string data_uri(const Bytes& bytes);

}  // namespace item3d
