// Loading of one image file of a dataset with its mask. Internal to dataset.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <optional>

namespace item3d {

enum class MaskOrigin { none, folder, mask_path, alpha, background, plain_border };

/// Returns the mask's file for a view in a folder of masks: NAME.png, or COLMAP's PICTURE.jpg.png;
/// empty if there is none.
std::filesystem::path find_mask(const std::filesystem::path& folder, const SourceView& view);

/// Returns the colour of a plain background: that of nine tenths of the image's border, within
/// `tolerance` in each channel. nullopt if there is none, or the whole image has it.
std::optional<Vec3> plain_border_color(const Image& image, float tolerance);

struct LoadedPhotograph {
    Image image;                 ///< premultiplied, linear, undistorted, shrunk, the right way up
    Lens lens;                   ///< ideal, for the image
    Mat4 camera_to_world{1.0f};  ///< the view's, rotated with the image
    MaskOrigin mask = MaskOrigin::none;
    double exposure = 0;  ///< CameraMetadata::exposure
};

/// Loads the image of a view, whose lens may be for a larger one of the same proportions. mask_file
/// may be empty; a mask may be oriented as the image is stored or as it is shown. Throws
/// InputError.
LoadedPhotograph load_photograph(const SourceView& view, const std::filesystem::path& mask_file,
                                 const DatasetOptions& options);

}  // namespace item3d
