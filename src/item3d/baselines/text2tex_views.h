// Text2Tex's masks and its automatic choice of views (Chen et al. 2023, section 3).
#pragma once

#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Pixels of a view, [1, 1, S, S] each.
struct GenerationInput {
    at::Tensor editable;  ///< 0 or 1: pixels that may change
    at::Tensor painted;   ///< 0 or 1: a view painted them
    at::Tensor cosine;    ///< similarity: between normal and the way to the camera
    at::Tensor best;      ///< the same of the view that sees the place best, of all there are
};

/// [1, 1, S, S] of 0 and 1 each; no pixel is in two of them, and one that is seen at too flat an
/// angle, or at the border of what is not, is in none.
struct GenerationMask {
    at::Tensor fresh;   ///< "new": not painted yet
    at::Tensor update;  ///< painted, and no view sees it better
    at::Tensor keep;    ///< painted otherwise
};

/// A pixel counts where its cosine, eroded twice by squares of 3 pixels of 768, is above 0.1.
GenerationMask make_generation_mask(const GenerationInput& input);

/// How much a view would add: the sum over the picture's pixels of 1 where fresh, 0.5 where updated
/// and 0.1 where kept, as a part of all pixels.
double view_heat(const GenerationMask& mask);

/// The index of the largest heat, each multiplied by 0.01 where its view was taken before. The
/// first of equal ones.
std::size_t choose_view(const std::vector<double>& heats, const std::vector<bool>& taken);

}  // namespace item3d
