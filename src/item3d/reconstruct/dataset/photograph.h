// One picture file of a dataset with its mask. Internal to dataset.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <optional>

namespace item3d {

enum class MaskOrigin { none, folder, mask_path, alpha, background, plain_border };

/// The mask's file for a view in a folder of masks: NAME.png, or PICTURE.jpg.png as COLMAP has it;
/// empty where there is none.
std::filesystem::path find_mask(const std::filesystem::path& folder, const SourceView& view);

/// The colour that nine tenths of a picture's border have, within `tolerance` in each channel: the
/// object stands before it. No value: there is none, or the whole picture has it.
std::optional<Vec3> plain_border_color(const Image& picture, float tolerance);

struct LoadedPhotograph {
    Image image;  ///< premultiplied, linear, undistorted, shrunk, shown the right way up
    Lens lens;    ///< ideal, of the image
    Mat4 camera_to_world{1.0f};  ///< the view's, turned as the picture was
    MaskOrigin mask = MaskOrigin::none;
    double exposure = 0;  ///< CameraFacts::exposure
};

/// The picture of a view, whose lens may be for a larger one of the same proportions. mask_file may
/// be empty; a mask may be turned as the picture is stored or as it is shown. Throws InputError.
LoadedPhotograph load_photograph(const SourceView& view, const std::filesystem::path& mask_file,
                                 const DatasetOptions& options);

}  // namespace item3d
