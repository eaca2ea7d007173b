// Text2Tex's masks and its automatic choice of views (Chen et al. 2023, section 3).
#pragma once

#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Input pixels of a view, [1, 1, S, S] each.
struct GenerationInput {
    at::Tensor editable;  ///< 0 or 1: pixels that may change
    at::Tensor painted;   ///< 0 or 1: painted by an earlier view
    at::Tensor cosine;    ///< cosine of the angle between normal and camera
    at::Tensor best;      ///< largest cosine over all views of both lists of Text2Tex
};

/// Disjoint masks [1, 1, S, S] of 0 and 1. No mask has pixels seen at a grazing angle, or pixels
/// near them.
struct GenerationMask {
    at::Tensor fresh;   ///< unpainted ("new" in the paper)
    at::Tensor update;  ///< painted, and best seen in this view
    at::Tensor keep;    ///< other painted pixels
};

/// Computes the masks, which have only valid pixels. To find these, the set of pixels with a cosine
/// above 0.1 is eroded twice, by squares of 3 pixels in an image of 768.
GenerationMask make_generation_mask(const GenerationInput& input);

/// Returns the heat of a view, which is what painting it gains: the mean over the image's pixels of
/// 1 in `fresh`, 0.5 in `update`, 0.1 in `keep` and 0 elsewhere.
double view_heat(const GenerationMask& mask);

/// Returns the index of the view with the largest heat (view_heat()); among equal heats, the first.
/// The heats of views already taken are multiplied by 0.01.
std::size_t choose_view(const std::vector<double>& heats, const std::vector<bool>& taken);

}  // namespace item3d
