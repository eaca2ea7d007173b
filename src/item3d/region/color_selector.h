// Selectors by the model's own base colour.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// Returns CIELAB [P, 3] of linear Rec.709 RGB [P, 3] (see metrics/color.h).
at::Tensor lab_of(const at::Tensor& linear);

/// "COLOR" or "COLOR~DISTANCE" (CIE 1976): by the base colour at full resolution, including factors
/// and vertex colours. Weights fall from 1 at the distance to 0 at 1.5 times the distance, to
/// include texels of antialiased edges. Throws InputError.
std::unique_ptr<Selector> select_color(const SelectorText& text, const RegionScene& scene);

/// One of basic_colors(): where it is the nearest one to the base colour, mainly by hue, so that
/// worn or shaded red is red. Throws InputError that lists them.
std::unique_ptr<Selector> select_named(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
