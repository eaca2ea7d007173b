// Texels of a source's textures as the pictures of an edit have them: factors multiplied in.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"
#include "item3d/scene/model.h"

namespace item3d {

/// The image is RGB, or RGBA, whose alpha takes its factor (1 where the texels have none), of the
/// texels' size; all values sRGB-encoded. A factor of 1 leaves texels to the bit.
void copy_base_color(const Image& texels, const Vec4& factor, Image& image);

/// The source of an image with occlusion, roughness and metallic. Null: none, or not of its size.
struct OrmTexels {
    const Image* occlusion = nullptr;
    const Image* roughness_metallic = nullptr;  ///< three channels or more
    float occlusion_strength = 1;
};

/// Red is 1 without texels of occlusion; green and blue stay without texels of theirs.
void copy_orm(const OrmTexels& texels, const Material& material, Image& image);

/// Null: flat everywhere. The texels have three channels or more.
void copy_normal(const Image* texels, Image& image);

}  // namespace item3d
