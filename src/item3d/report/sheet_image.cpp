#include "item3d/report/sheet_image.h"

#include "item3d/report/contact_sheet.h"

#include <algorithm>

namespace item3d {

Image first_image(const Image& sheet, int columns) {
    constexpr int title_scale = 2;
    const int gap = ContactSheetOptions().gap;
    const int side = (sheet.width - gap) / columns - gap;
    const int top = 2 * gap + text_height(title_scale);
    if (side <= 0 || top + side > sheet.height) return {};
    Image image(side, side, sheet.channels);
    for (int y = 0; y < side; ++y)
        std::copy_n(
            &sheet.pixels[(static_cast<std::size_t>(top + y) * sheet.width + gap) * sheet.channels],
            static_cast<std::size_t>(side) * sheet.channels,
            &image.pixels[static_cast<std::size_t>(y) * side * sheet.channels]);
    return image;
}

}  // namespace item3d
