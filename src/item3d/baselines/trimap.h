// TEXTure's trimap (Richardson et al. 2023, section 3): what of a view is painted for the first
// time, what is painted again because it is seen better now, and what stays.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Pixels of a view, [1, 1, S, S] each.
struct TrimapInput {
    at::Tensor covered;    ///< 0 or 1: the model
    at::Tensor editable;   ///< 0 or 1: what may change of it
    at::Tensor unpainted;  ///< 0 or 1: no view has painted it
    at::Tensor cosine;     ///< between normal and the way to the camera
    at::Tensor best;       ///< the cosine at which it was painted best; 0: not yet
};

/// [1, 1, S, S] of 0 and 1 each. Every pixel of the model that may change is in one of the first
/// three.
struct Trimap {
    at::Tensor generate;
    at::Tensor refine;
    at::Tensor keep;
    at::Tensor update;  ///< generate and refine, less what lies outside of the eroded model
};

/// Widths are as in the published code, whose pictures have 1200 pixels, as parts of S: generate is
/// dilated by 19 of these, refine (where cosine > best + 0.2) opened by 5, the model eroded by 7.
Trimap make_trimap(const TrimapInput& input);

/// Where a view's picture goes to the texture, and how much of it, [1, 1, S, S] in [0, 1]: the
/// model eroded by 5 and the update dilated by 25 of 1200, through a Gaussian of 21 pixels (sigma
/// 16), 0 below a half and where the surface was painted from more squarely than by 0.2.
at::Tensor projection_mask(const TrimapInput& input, const at::Tensor& update);

/// An odd number of pixels, `published` of 1200, on a picture of `size`; 1 changes nothing.
int scaled_width(int published, std::int64_t size);
/// Squares of `width` pixels; beyond the picture is nothing, or for erosion the model.
at::Tensor dilate(const at::Tensor& mask, int width);
at::Tensor erode(const at::Tensor& mask, int width);

}  // namespace item3d
