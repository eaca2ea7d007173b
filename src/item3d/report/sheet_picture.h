// A picture of a contact sheet, cut out again.
#pragma once

#include "item3d/scene/image.h"

namespace item3d {

/// The first picture of a contact_sheet() that has a title, square pictures without labels, and the
/// gap of ContactSheetOptions; empty where the sheet is too small for that.
Image first_picture(const Image& sheet, int columns);

}  // namespace item3d
