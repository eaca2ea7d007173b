// The sum of one image of a model and the changes of several layers.
#pragma once

#include "item3d/io/edited_texture.h"
#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

struct ImageTerm {
    const LayerImage* image;
    std::int64_t strength;  ///< in units of 1 / LayerUse::strength_steps
    unsigned channels;      ///< bit c: channel c
    std::string subject;    ///< subject of errors: the layer's file
};

/// Returns the first term's image before its edit, plus the changes of all terms. Values are a
/// file's integers, rounded to nearest and clamped once. Where the model has no texture, smaller
/// images are enlarged bilinearly. Throws InputError where sizes, channels or bits of the terms
/// differ otherwise.
EditedTexture image_sum(const std::vector<ImageTerm>& terms, const Model& model, int material,
                        const MaterialEdit& changes, bool remakes_uvs);

}  // namespace item3d
