// Camera metadata of a JPEG file (EXIF).
#pragma once

#include "item3d/core/files.h"

#include <filesystem>
#include <optional>
#include <string>

namespace item3d {

struct CameraMetadata {
    int orientation = 1;  ///< EXIF's orientation, 1 to 8; 1 means shown as stored
    /// 35 mm equivalent of the focal length, in millimetres: the focal length that gives film of 36
    /// mm x 24 mm the same diagonal angle of view. It is 0 if unknown.
    double focal_35 = 0;
    double focal = 0;  ///< focal length of the lens itself, in millimetres; 0 if unknown
    /// Exposure time in seconds times ISO / 100, divided by the square of the f-number if this
    /// number is known. Pixel values are proportional to radiance times this exposure. It is 0 if
    /// unknown.
    double exposure = 0;
    std::string camera = {};  ///< maker, model and lens, joined
    int width = 0;            ///< stored size of the camera's image; 0 if unknown
    int height = 0;
};

/// Reads EXIF from a file's bytes. A number that is no valid size, time or length counts as
/// unknown.
CameraMetadata camera_metadata(const Bytes& file);
/// Reads EXIF from a file's beginning. An unreadable file gives unknown values.
CameraMetadata camera_metadata(const std::filesystem::path& file);

/// Returns the focal length in pixels of an image of the given size, as stored or shown. Returns 0
/// if EXIF lacks the focal length, or describes an image of other proportions because the image was
/// cropped later.
double focal_in_pixels(const CameraMetadata& metadata, int width, int height);

struct ImageSize {
    int width = 0, height = 0;
    auto operator<=>(const ImageSize&) const = default;
};

/// Returns the stored size of a PNG or JPEG, recognized by content; nullopt for other files.
std::optional<ImageSize> stored_size(const Bytes& file);

}  // namespace item3d
