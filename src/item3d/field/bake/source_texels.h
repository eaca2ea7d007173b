// The conversion of a source's texels to an edit's images, in which they are multiplied by their
// factors.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Writes the texels times the factor to `image`, which has the same size and is RGB or RGBA. If
/// the texels have no alpha, it counts as 1. All values are sRGB-encoded. A factor of 1 copies
/// texels bit for bit.
void copy_base_color(const Image& texels, const Vec4& factor, Image& image);

/// Source texels for an image of occlusion, roughness and metallic. A pointer is null if there is
/// no texture, or if it has another size.
struct OrmTexels {
    const Image* occlusion = nullptr;
    const Image* roughness_metallic = nullptr;  ///< three channels or more
    float occlusion_strength = 1;
};

/// Sets red to 1 if occlusion is null. Keeps green and blue if roughness_metallic is null.
void copy_orm(const OrmTexels& texels, const Material& material, Image& image);

/// Copies texels, which have three channels or more, to `image`. If `texels` is null, `image`
/// becomes a flat normal map.
void copy_normal(const Image* texels, Image& image);

}  // namespace item3d
