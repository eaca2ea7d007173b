#include "item3d/report/contact_sheet.h"

#include "item3d/core/error.h"
#include "item3d/report/display_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

namespace item3d {

namespace {

/// Returns one character for each code point. It is '?' for a code point that the font lacks.
std::string printable(const std::string& text) {
    std::string result;
    for (const char character : text) {
        const auto byte = static_cast<unsigned char>(character);
        if ((byte & 0xc0) == 0x80) continue;  // continuation of a UTF-8 sequence
        result += byte >= 32 && byte < 127 ? character : '?';
    }
    return result;
}

/// Shortens the text so that it is at most `width` pixels wide.
std::string fitted(std::string text, int width, int scale) {
    text = printable(text);
    if (text_width(text, scale) <= width) return text;
    while (!text.empty() && text_width(text + "...", scale) > width)
        text.pop_back();
    return text + "...";
}

void fill(Image& image, int left, int top, int right, int bottom, Vec3 color) {
    for (int y = std::max(top, 0); y < std::min(bottom, image.height); ++y) {
        for (int x = std::max(left, 0); x < std::min(right, image.width); ++x) {
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = color[c];
        }
    }
}

void paste(Image& page, const Image& image, int left, int top) {
    for (int y = 0; y < image.height; ++y) {
        std::copy_n(&image.pixels[static_cast<std::size_t>(y) * image.width * 3],
                    static_cast<std::size_t>(image.width) * 3, &page.at(left, top + y, 0));
    }
}

/// Scales a flattened image to fit into width x height.
Image fit(const Image& image, int width, int height) {
    const double scale = std::min(static_cast<double>(width) / image.width,
                                  static_cast<double>(height) / image.height);
    return resize(image, std::clamp(static_cast<int>(std::lround(image.width * scale)), 1, width),
                  std::clamp(static_cast<int>(std::lround(image.height * scale)), 1, height));
}

}  // namespace

void draw_text(Image& image, int x, int y, const std::string& text, Vec3 color, int scale) {
    ITEM3D_CHECK(image.channels >= 3 && scale >= 1, "text needs an RGB image");
    struct Vertex {
        float x;
        float y;
        float z;
        unsigned char color[4];
    };
    std::string line = printable(text);
    std::vector<Vertex> vertices(std::max<std::size_t>(line.size(), 1) * 80);
    const int quads = stb_easy_font_print(0, 0, line.data(), nullptr, vertices.data(),
                                          static_cast<int>(vertices.size() * sizeof(Vertex)));
    for (int i = 0; i < quads; ++i) {
        const Vertex& low = vertices[4 * i];
        const Vertex& high = vertices[4 * i + 2];
        fill(image, x + scale * static_cast<int>(low.x), y + scale * static_cast<int>(low.y),
             x + scale * static_cast<int>(high.x), y + scale * static_cast<int>(high.y), color);
    }
}

int text_width(const std::string& text, int scale) {
    std::string line = printable(text);
    return scale * stb_easy_font_width(line.data());
}

int text_height(int scale) {
    return 12 * scale;
}

Image contact_sheet(const std::vector<Tile>& tiles, const ContactSheetOptions& options) {
    ITEM3D_CHECK(!tiles.empty(), "a contact sheet needs an image");
    int width = options.tile_width;
    int height = options.tile_height;
    bool labelled = false;
    for (const Tile& tile : tiles) {
        if (options.tile_width == 0) width = std::max(width, tile.image.width);
        if (options.tile_height == 0) height = std::max(height, tile.image.height);
        labelled = labelled || !tile.label.empty();
    }
    ITEM3D_CHECK(width > 0 && height > 0, "a contact sheet needs images with pixels");
    const int count = static_cast<int>(tiles.size());
    const int columns = options.columns > 0
                            ? options.columns
                            : static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count))));
    const int rows = (count + columns - 1) / columns;
    const int gap = options.gap;
    const int scale = width >= 384 ? 2 : 1;
    const int label_height = labelled ? text_height(scale) + gap / 2 : 0;
    const int title_scale = 2;
    const int title_height = options.title.empty() ? 0 : text_height(title_scale) + gap;

    Image page(columns * (width + gap) + gap,
               rows * (height + label_height + gap) + gap + title_height, 3);
    fill(page, 0, 0, page.width, page.height, options.paper);
    if (!options.title.empty()) {
        draw_text(page, gap, gap, fitted(options.title, page.width - 2 * gap, title_scale),
                  options.ink, title_scale);
    }
    for (int i = 0; i < count; ++i) {
        const int left = gap + i % columns * (width + gap);
        const int top = gap + title_height + i / columns * (height + label_height + gap);
        if (!tiles[i].image.empty()) {
            fill(page, left, top, left + width, top + height, options.ground);
            const Image image = fit(flatten(tiles[i].image, options.ground), width, height);
            paste(page, image, left + (width - image.width) / 2, top + (height - image.height) / 2);
        }
        draw_text(page, left, top + height + gap / 2, fitted(tiles[i].label, width, scale),
                  options.ink, scale);
    }
    return page;
}

}  // namespace item3d
