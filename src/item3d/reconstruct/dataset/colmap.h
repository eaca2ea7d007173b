// Reader of COLMAP's sparse models (https://colmap.github.io/format.html), text and binary.
#pragma once

#include "item3d/reconstruct/dataset/source.h"

#include <cstddef>
#include <filesystem>

namespace item3d {

/// True if the folder contains the cameras and images of a model, text or binary.
bool is_colmap_model(const std::filesystem::path& folder);

/// Returns the number of images in a model's list. Throws InputError if the list cannot be read.
std::size_t count_colmap_images(const std::filesystem::path& model);

/// Reads COLMAP's cameras and images, text or binary, in `model`; image names are relative to
/// `images`. Supports the camera models SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV,
/// FULL_OPENCV, OPENCV_FISHEYE, SIMPLE_RADIAL_FISHEYE and RADIAL_FISHEYE.
SourceDataset read_colmap(const std::filesystem::path& model, const std::filesystem::path& images);

}  // namespace item3d
