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
    unsigned channels;      ///< bit c stands for channel c
    std::string subject;    ///< the layer's file, for errors
};

/// Returns the first term's image before its edit, plus the changes of all terms. Values are
/// integers, as in files; the sum is rounded to nearest and clamped once. If the model has no
/// texture, smaller images are enlarged bilinearly. Throws InputError if sizes, channels or bits of
/// the terms differ in any other case.
EditedTexture image_sum(const std::vector<ImageTerm>& terms, const Model& model, int material,
                        const MaterialEdit& changes, bool remakes_uvs);

}  // namespace item3d
