// Extraction of an image from a contact sheet.
#pragma once

#include "item3d/scene/image.h"

namespace item3d {

/// Returns the first image of a contact_sheet(). The sheet must have a title, square images without
/// labels, and the gap of ContactSheetOptions. Returns an empty image if the sheet is too small for
/// that.
Image first_image(const Image& sheet, int columns);

}  // namespace item3d
