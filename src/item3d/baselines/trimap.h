// TEXTure's trimap (Richardson et al. 2023, section 3). It divides a view into the parts that are
// painted for the first time, the parts that are repainted because this view sees them better, and
// the parts that are kept.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Input pixels of a view, [1, 1, S, S] each.
struct TrimapInput {
    at::Tensor covered;    ///< 0 or 1: covered by the model
    at::Tensor editable;   ///< 0 or 1: may change
    at::Tensor unpainted;  ///< 0 or 1: not painted by any view
    at::Tensor cosine;     ///< cosine of the angle between normal and camera
    at::Tensor best;       ///< largest cosine of the views that painted the pixel; 0: unpainted
};

/// Masks [1, 1, S, S] of 0 and 1. Every pixel of the model that may change is in `generate`,
/// `refine` or `keep`.
struct Trimap {
    at::Tensor generate;
    at::Tensor refine;
    at::Tensor keep;
    at::Tensor update;  ///< `generate`, and the part of `refine` in the eroded model
};

/// Computes the trimap. `generate` is dilated, `refine` (where cosine > best + 0.2) is opened, and
/// the model is eroded. Their widths are those of the published code, 19, 5 and 7 pixels in an
/// image of 1200.
Trimap make_trimap(const TrimapInput& input);

/// Returns the weight of a view's image in the texture, [1, 1, S, S] in [0, 1]. The weight is a
/// mask, blurred by a Gaussian of 21 pixels (sigma 16). The mask has the editable pixels that are
/// in both the model, eroded by 5 pixels, and `update`, dilated by 25. The weight is 0 outside of
/// the mask, where it would be below a half, and where the surface was painted at a cosine larger
/// by more than 0.2. All widths are pixels in an image of 1200.
at::Tensor projection_mask(const TrimapInput& input, const at::Tensor& update);

/// Converts a width of `published` pixels in an image of 1200 pixels to an odd number of pixels in
/// an image of `size` pixels. A dilation or an erosion by a width of 1 has no effect.
int scaled_width(int published, std::int64_t size);
/// dilate() and erode() use squares of `width` pixels. Pixels outside of the image count as 0 for
/// dilate() and as 1 for erode().
at::Tensor dilate(const at::Tensor& mask, int width);
at::Tensor erode(const at::Tensor& mask, int width);

}  // namespace item3d
