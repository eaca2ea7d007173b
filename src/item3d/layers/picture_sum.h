// One picture of a model with the changes of several layers.
#pragma once

#include "item3d/io/edited_texture.h"
#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

struct PictureTerm {
    const LayerPicture* picture;
    std::int64_t strength;  ///< in parts of LayerUse::strength_steps
    unsigned channels;      ///< bit c: channel c
    std::string subject;    ///< of errors: the layer's file
};

/// The picture before the edit, as the first of the terms has it, plus all terms: integers of a
/// file, rounded to the nearest and clamped once. Of pictures that the model has no texture for,
/// smaller ones are enlarged, bilinearly. Throws InputError where sizes, channels or bits of the
/// terms differ otherwise.
EditedTexture picture_sum(const std::vector<PictureTerm>& terms, const Model& model, int material,
                          const MaterialEdit& changes, bool remakes_uvs);

}  // namespace item3d
