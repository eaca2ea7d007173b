// Materials and light that are looked for.
#pragma once

#include "item3d/field/neural_texture.h"
#include "item3d/reconstruct/surface/trainable_light.h"
#include "item3d/reconstruct/surface/view_render.h"

#include <array>
#include <cstdint>
#include <vector>

namespace item3d {

struct Appearance {
    NeuralTexture field = nullptr;
    TrainableLight light;
};

/// Where materials and light begin.
enum class AppearanceStart {
    /// Rough paint in a coarse light: while the shape is looked for, what shines would dent it.
    matt,
    /// Half a metal and smooth, in a light fine enough to be mirrored. From rough materials a
    /// light stays blurred, and by a blurred light nothing can become smooth; from smooth ones
    /// both sharpen each other, and what is rough is soon found to be.
    smooth,
};

/// Ranges of the materials that are looked for.
MaterialRanges reconstruction_ranges();

/// A field around `bounds` whose finest cells are about the size of a pixel of the photographs.
Appearance make_appearance(std::array<Vec3, 2> bounds, const std::vector<TargetView>& views,
                           AppearanceStart start, std::uint64_t seed);

/// World units of a pixel of a view at the middle of the bounds.
float pixel_size(std::array<Vec3, 2> bounds, const TargetView& view);

}  // namespace item3d
