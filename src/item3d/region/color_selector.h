// Selectors by the model's own base colour.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// Returns CIELAB [P, 3] of linear Rec.709 RGB [P, 3] (see metrics/color.h).
at::Tensor lab_of(const at::Tensor& linear);

/// Selects by base colour: "COLOR" or "COLOR~DISTANCE" (CIE 1976). The base colour is read at full
/// resolution, including factors and vertex colours. Weights fall from 1 at the distance to 0 at
/// 1.5 times the distance, to include texels of antialiased edges. Throws InputError.
std::unique_ptr<Selector> select_color(const SelectorText& text, const RegionScene& scene);

/// Selects the surface whose base colour is nearer to the given one of basic_colors() than to the
/// others. Distances depend mainly on hue, so that worn or shaded red is red. Throws InputError
/// that lists the colours.
std::unique_ptr<Selector> select_named(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
