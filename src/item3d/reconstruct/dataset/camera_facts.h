// What a camera wrote into a JPEG besides the picture: EXIF.
#pragma once

#include "item3d/core/files.h"

#include <filesystem>
#include <optional>
#include <string>

namespace item3d {

struct CameraFacts {
    int orientation = 1;  ///< 1 to 8; 1: shown as stored
    /// Millimetres of the lens whose 36 x 24 pictures, by their diagonals, show as much; 0: not
    /// said.
    double focal_35 = 0;
    double focal = 0;  ///< millimetres of the lens itself; 0: not said
    /// Time in seconds times ISO / 100, by the square of the aperture's number where that is said:
    /// what radiance is multiplied by, up to a factor. 0: not said.
    double exposure = 0;
    std::string camera = {};  ///< maker, model and lens, in one
    int width = 0;            ///< of the picture as the camera stored it; 0: not said
    int height = 0;
};

/// Numbers that are no sizes, times or lengths count as not said.
CameraFacts camera_facts(const Bytes& file);
/// Of a file, of which no more is read than EXIF may take. Nothing is said by what cannot be read.
CameraFacts camera_facts(const std::filesystem::path& file);

/// In pixels of a picture of that size, as it is stored or shown; 0 where EXIF does not say it, or
/// speaks of a picture of other proportions: it was cropped since.
double focal_in_pixels(const CameraFacts& facts, int width, int height);

struct PictureSize {
    int width = 0, height = 0;
    auto operator<=>(const PictureSize&) const = default;
};

/// As stored, of PNG and JPEG by their content; nothing for other files.
std::optional<PictureSize> stored_size(const Bytes& file);

}  // namespace item3d
