// TEXTure's trimap (Richardson et al. 2023, section 3): the parts of a view that are painted for
// the first time, repainted because this view sees them better, and kept.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Input pixels of a view, [1, 1, S, S] each.
struct TrimapInput {
    at::Tensor covered;    ///< 0 or 1: covered by the model
    at::Tensor editable;   ///< 0 or 1: may change
    at::Tensor unpainted;  ///< 0 or 1: not painted by any view
    at::Tensor cosine;     ///< between normal and direction to the camera
    at::Tensor best;       ///< largest cosine of the views that painted it; 0: unpainted
};

/// Masks [1, 1, S, S] of 0 and 1. Every pixel of the model that may change is in one of the first
/// three.
struct Trimap {
    at::Tensor generate;
    at::Tensor refine;
    at::Tensor keep;
    at::Tensor update;  ///< generate, and refine within the eroded model
};

/// Computes the trimap. Widths are those of the published code, relative to its images of 1200
/// pixels: generate is dilated by 19 of these, refine (where cosine > best + 0.2) opened by 5, the
/// model eroded by 7.
Trimap make_trimap(const TrimapInput& input);

/// Returns the weight of a view's image in the texture, [1, 1, S, S] in [0, 1]: a mask, blurred by
/// a Gaussian of 21 pixels of 1200 (sigma 16). The mask has the editable pixels that are in both
/// the model, eroded by 5, and the update, dilated by 25. The weight is 0 outside of the mask,
/// where it is below a half, and where the surface was painted at a cosine larger by 0.2.
at::Tensor projection_mask(const TrimapInput& input, const at::Tensor& update);

/// Converts a width of `published` pixels in an image of 1200 to an odd number of pixels in an
/// image of `size`. A width of 1 has no effect.
int scaled_width(int published, std::int64_t size);
/// Dilate or erode by squares of `width` pixels. Pixels outside of the image count as 0, for
/// erosion as 1.
at::Tensor dilate(const at::Tensor& mask, int width);
at::Tensor erode(const at::Tensor& mask, int width);

}  // namespace item3d
