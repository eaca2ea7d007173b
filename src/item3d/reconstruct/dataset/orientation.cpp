#include "item3d/reconstruct/dataset/orientation.h"

#include <libexif/exif-data.h>

#include <memory>

namespace item3d {

int exif_orientation(const Bytes& file) {
    const std::unique_ptr<ExifData, decltype(&exif_data_unref)> data(
        exif_data_new_from_data(file.data(), static_cast<unsigned int>(file.size())),
        &exif_data_unref);
    if (!data) return 1;
    const ExifEntry* entry = exif_content_get_entry(data->ifd[EXIF_IFD_0], EXIF_TAG_ORIENTATION);
    if (entry == nullptr || entry->format != EXIF_FORMAT_SHORT || entry->size < 2) return 1;
    const int value = exif_get_short(entry->data, exif_data_get_byte_order(data.get()));
    return value >= 1 && value <= 8 ? value : 1;
}

bool swaps_sides(int orientation) {
    return orientation >= 5;
}

Image oriented(const Image& stored, int orientation) {
    if (orientation == 1) return stored;
    const bool swaps = swaps_sides(orientation);
    Image result(swaps ? stored.height : stored.width, swaps ? stored.width : stored.height,
                 stored.channels);
    // EXIF names the sides that the stored first row and first column are on.
    const bool from_right =
        orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
    const bool from_bottom =
        orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
    for (int y = 0; y < stored.height; ++y) {
        for (int x = 0; x < stored.width; ++x) {
            int u = swaps ? y : x, v = swaps ? x : y;
            if (from_right) u = result.width - 1 - u;
            if (from_bottom) v = result.height - 1 - v;
            for (int c = 0; c < stored.channels; ++c)
                result.at(u, v, c) = stored.at(x, y, c);
        }
    }
    return result;
}

}  // namespace item3d
