// Camera metadata of a JPEG file (EXIF).
#pragma once

#include "item3d/core/files.h"

#include <filesystem>
#include <optional>
#include <string>

namespace item3d {

struct CameraMetadata {
    int orientation = 1;  ///< 1 to 8; 1: shown as stored
    /// 35 mm equivalent of the focal length in millimetres: the one that gives 36 x 24 film the
    /// same diagonal angle of view. 0: unknown.
    double focal_35 = 0;
    double focal = 0;  ///< millimetres, of the lens itself; 0: unknown
    /// Exposure time in seconds times ISO / 100, divided by the square of the f-number if known.
    /// Pixel values are proportional to radiance times this exposure. 0: unknown.
    double exposure = 0;
    std::string camera = {};  ///< maker, model and lens, joined
    int width = 0;            ///< stored size of the camera's image; 0: unknown
    int height = 0;
};

/// Reads EXIF from a file's bytes. Numbers that are no valid sizes, times or lengths count as
/// unknown.
CameraMetadata camera_metadata(const Bytes& file);
/// Reads EXIF from a file's beginning. An unreadable file gives unknown values.
CameraMetadata camera_metadata(const std::filesystem::path& file);

/// Returns the focal length in pixels of an image of the given size, as stored or shown; 0 if EXIF
/// lacks it, or describes an image of other proportions (cropped since).
double focal_in_pixels(const CameraMetadata& metadata, int width, int height);

struct ImageSize {
    int width = 0, height = 0;
    auto operator<=>(const ImageSize&) const = default;
};

/// Returns the stored size of a PNG or JPEG, recognized by content; nullopt for other files.
std::optional<ImageSize> stored_size(const Bytes& file);

}  // namespace item3d
