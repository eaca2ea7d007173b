// A model's images in the state before an edit.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

#include <cstdint>

namespace item3d {

/// Converts a value to a file's integer of `bits` bits per channel, in [0, 2^bits - 1].
std::int32_t to_file_value(float value, int bits);
/// Converts a file's integer back to [0, 1], as readers do.
float from_file_value(std::int32_t value, int bits);

/// True if the image before the edit follows from the model: it is the texture without resampling,
/// times the material's factors, or the factors alone. remakes_uvs: true if the material has a new
/// UV map.
bool has_source_image(const Model& model, int material, const LayerImage& image,
                      const MaterialEdit& changes, bool remakes_uvs);

/// Returns the image before the edit, in the size and channels of `image`, in [0, 1]. Requires
/// has_source_image().
Image source_image(const Model& model, int material, const LayerImage& image,
                   const MaterialEdit& changes);

/// Returns the size of one of Model::textures; no value for -1.
std::optional<LayerSize> texture_size(const Model& model, int texture);
/// These functions return the sizes that LayerImage::source_size and occlusion_size store.
std::optional<LayerSize> source_size(const Model& model, int material, LayerSlot slot);
std::optional<LayerSize> occlusion_size(const Model& model, int material, LayerSlot slot);

}  // namespace item3d
