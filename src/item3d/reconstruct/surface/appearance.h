// Unknown materials and light of a reconstruction.
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

/// Initial materials and light.
enum class AppearanceStart {
    /// Rough paint in a light of low resolution. A shiny material would dent the shape while the
    /// shape is still unknown.
    matt,
    /// Half metallic and smooth, in a light fine enough for reflections. If the optimisation starts
    /// from rough materials, the light stays blurred, and in a blurred light no material becomes
    /// smooth. If it starts from smooth materials, light and materials become sharp together, and
    /// rough surfaces are soon found.
    smooth,
};

/// Returns the ranges of the optimised materials.
MaterialRanges reconstruction_ranges();

/// Makes a field around `bounds` whose finest cells are about the size of a pixel of the
/// photographs.
Appearance make_appearance(std::array<Vec3, 2> bounds, const std::vector<TargetView>& views,
                           AppearanceStart start, std::uint64_t seed);

/// Returns the size in world units of a view's pixel at the middle of the bounds.
float pixel_size(std::array<Vec3, 2> bounds, const TargetView& view);

}  // namespace item3d
