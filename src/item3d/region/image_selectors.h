// Selectors by painted images.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// "FILE" or "FILE@MATERIAL": white times alpha of an image in the first UV map, repeated beyond
/// it; for all materials with UVs, or for one. Notes a size that differs from the texture's. Throws
/// InputError, also if the image selects nothing.
std::unique_ptr<Selector> select_mask(const SelectorText& text, const RegionScene& scene);

/// "FILE" or "FILE@CAMERA": white times alpha of a render of the model, on visible surfaces that
/// face its camera. CAMERA: "AZIMUTH,ELEVATION" in degrees, framed as in `item3d render`; a
/// transforms.json, or "transforms.json#FRAME". Throws InputError.
std::unique_ptr<Selector> select_view(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
