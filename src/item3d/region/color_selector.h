// A selector by the model's own base colour.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// CIELAB [P, 3] of linear Rec.709 RGB [P, 3] (see metrics/color.h).
at::Tensor lab_of(const at::Tensor& linear);

/// "COLOR" or "COLOR~DISTANCE" (CIE 1976), of the base colour at full resolution, factors and
/// vertex colours included. Weights fall from 1 at the distance to 0 at one and a half times it:
/// texels that a painted edge mixes go along. Throws InputError.
std::unique_ptr<Selector> select_color(const SelectorText& text, const RegionScene& scene);

/// One of basic_colors(): where the base colour is nearer to it than to the others, above all by
/// hue, so that worn or shaded red is red. Throws InputError that lists them.
std::unique_ptr<Selector> select_named(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
