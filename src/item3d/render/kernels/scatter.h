// Scattering of values at covered pixels into images: image[pixel[i]] = values[i]. All other pixels
// have the background. Pixels are distinct, so no index waits for another. The backward pass
// gathers the gradient.
//
//     values   [P, C]          pixel       [P] indices into N H W
//     image  [N H W, C]      background  [N H W, C], or [C] with a stride of 0
#pragma once

#include "item3d/core/host_device.h"

#include <cstdint>

namespace item3d::kernels {

struct ScatterParameters {
    const float* values;             ///< [P, C]
    const float* background;         ///< [pixels, C], or [C] for one colour
    const std::int64_t* pixel;       ///< [P], distinct pixels
    std::int64_t channels;           ///< C
    std::int64_t background_stride;  ///< floats between the backgrounds of two pixels: C, or 0
    float* image;                    ///< [pixels, C]
};

ITEM3D_HOST_DEVICE inline void scatter_background(const ScatterParameters& p, std::int64_t pixel) {
    for (std::int64_t c = 0; c < p.channels; ++c)
        p.image[pixel * p.channels + c] = p.background[pixel * p.background_stride + c];
}

/// Writes one value. It runs after scatter_background() of all pixels.
ITEM3D_HOST_DEVICE inline void scatter_value(const ScatterParameters& p, std::int64_t index) {
    for (std::int64_t c = 0; c < p.channels; ++c)
        p.image[p.pixel[index] * p.channels + c] = p.values[index * p.channels + c];
}

}  // namespace item3d::kernels
