// Text2Tex's masks and its automatic choice of views (Chen et al. 2023, section 3).
#pragma once

#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Input pixels of a view, [1, 1, S, S] each.
struct GenerationInput {
    at::Tensor editable;  ///< 0 or 1: pixels that may change
    at::Tensor painted;   ///< 0 or 1: painted by a view
    at::Tensor cosine;    ///< cosine between normal and direction to the camera
    at::Tensor best;      ///< largest cosine over all views
};

/// Disjoint masks [1, 1, S, S] of 0 and 1. Pixels seen at a grazing angle, and pixels near them,
/// are in none.
struct GenerationMask {
    at::Tensor fresh;   ///< "new": unpainted
    at::Tensor update;  ///< painted, and best seen in this view
    at::Tensor keep;    ///< other painted pixels
};

/// Computes the masks. A pixel is valid if its cosine, eroded twice by squares of 3 pixels of 768,
/// is above 0.1.
GenerationMask make_generation_mask(const GenerationInput& input);

/// Returns the gain of a view: the sum over the image's pixels of 1 where fresh, 0.5 where updated
/// and 0.1 where kept, divided by the number of pixels.
double view_heat(const GenerationMask& mask);

/// Returns the index of the view with the largest heat (view_heat()), the first of equal ones. The
/// heats of taken views are multiplied by 0.01.
std::size_t choose_view(const std::vector<double>& heats, const std::vector<bool>& taken);

}  // namespace item3d
