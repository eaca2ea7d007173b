// Contact sheets: labelled images in a grid.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <string>
#include <vector>

namespace item3d {

struct Tile {
    /// SRGB with 1 to 4 channels (straight alpha); an empty image is an empty cell.
    Image image;
    std::string label;  ///< text below the image; may be empty
};

struct ContactSheetOptions {
    int columns = 0;      ///< number of columns; 0 for a sheet as square as possible
    int tile_width = 0;   ///< 0 for the largest image's width; other images are scaled to fit
    int tile_height = 0;  ///< 0 for the largest image's height
    int gap = 12;
    std::string title;
    Vec3 paper{0.961f, 0.957f, 0.945f};   ///< sRGB colour of the sheet's background
    Vec3 ground{0.898f, 0.890f, 0.871f};  ///< sRGB colour behind transparent images
    Vec3 ink{0.165f, 0.161f, 0.149f};     ///< sRGB colour of the text
};

/// Draws tiles row by row, left to right. Returns sRGB with three channels.
Image contact_sheet(const std::vector<Tile>& tiles, const ContactSheetOptions& options = {});

/// Draws one line of text with its upper left corner at (x, y). The font is 12 pixels high, and
/// each of its pixels is drawn `scale` pixels wide and high. Characters outside ASCII become '?'.
void draw_text(Image& image, int x, int y, const std::string& text, Vec3 color, int scale = 1);
int text_width(const std::string& text, int scale = 1);
int text_height(int scale = 1);

}  // namespace item3d
