// A model's pictures as an edit begins from them.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

#include <cstdint>

namespace item3d {

/// A value as a file of so many bits a channel has it, in [0, 2^bits - 1].
std::int32_t to_file_value(float value, int bits);
/// What readers make of it, in [0, 1].
float from_file_value(std::int32_t value, int bits);

/// Whether the picture before the edit follows from the model: texels that are not resampled, with
/// the material's factors, or the factors alone. remakes_uvs: the material has a new UV map.
bool has_source_picture(const Model& model, int material, const LayerPicture& picture,
                        const MaterialEdit& changes, bool remakes_uvs);

/// That picture, of the size and channels of `picture`, in [0, 1]; has_source_picture() holds.
Image source_picture(const Model& model, int material, const LayerPicture& picture,
                     const MaterialEdit& changes);

/// Of one of Model::textures; no value for -1.
std::optional<LayerSize> texture_size(const Model& model, int texture);
/// Sizes of the textures that LayerPicture::source_size and occlusion_size are of.
std::optional<LayerSize> source_size(const Model& model, int material, LayerSlot slot);
std::optional<LayerSize> occlusion_size(const Model& model, int material, LayerSlot slot);

}  // namespace item3d
