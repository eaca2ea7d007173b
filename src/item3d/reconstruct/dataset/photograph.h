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

/// A picture in the size of its lens (or both smaller by the same factor), the right way up,
/// undistorted, shrunk, premultiplied and linear. mask_file may be empty. Sets `lens` to that of
/// the result and `origin` to where the coverage came from. Throws InputError.
Image load_photograph(const SourceView& view, const std::filesystem::path& mask_file,
                      const DatasetOptions& options, Lens& lens, MaskOrigin& origin);

}  // namespace item3d
