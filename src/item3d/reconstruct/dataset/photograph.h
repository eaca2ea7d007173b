// Loading of one image file of a dataset with its mask. Internal to dataset.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <optional>

namespace item3d {

enum class MaskOrigin { none, folder, mask_path, alpha, background, plain_border };

/// Returns the mask's file for a view in a folder of masks: NAME.png, or COLMAP's PICTURE.jpg.png;
/// returns an empty path if there is none.
std::filesystem::path find_mask(const std::filesystem::path& folder, const SourceView& view);

/// Returns the colour of a plain background: nine tenths of the image's border have this colour,
/// within `tolerance` in each channel. Returns nullopt if there is no such colour, or if the whole
/// image has it.
std::optional<Vec3> plain_border_color(const Image& image, float tolerance);

struct LoadedPhotograph {
    /// Premultiplied, linear, undistorted and downscaled image, as shown.
    Image image;
    Lens lens;                   ///< ideal lens of this image
    Mat4 camera_to_world{1.0f};  ///< pose of the view, rotated with the image
    MaskOrigin mask = MaskOrigin::none;
    double exposure = 0;  ///< CameraMetadata::exposure
};

/// Loads the image of a view. The view's lens may be for a larger image of the same proportions.
/// `mask_file` may be empty. The mask may be oriented like the stored or like the shown image.
/// Throws InputError.
LoadedPhotograph load_photograph(const SourceView& view, const std::filesystem::path& mask_file,
                                 const DatasetOptions& options);

}  // namespace item3d
