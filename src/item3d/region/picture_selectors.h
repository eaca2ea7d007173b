// Selectors by painted pictures.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// "FILE" or "FILE@MATERIAL": white times alpha of a picture in the first UV map, repeated
/// beyond it; of all materials with UVs, or of one. A note where its size is not the texture's.
/// Throws InputError, also where nothing of it is white.
std::unique_ptr<Selector> select_mask(const SelectorText& text, const RegionScene& scene);

/// "FILE" or "FILE@CAMERA": white times alpha of a picture of the model, on the surfaces that face
/// its camera and that nothing hides. CAMERA: "AZIMUTH,ELEVATION" in degrees, framed as
/// `item3d render` does; a transforms.json, or "transforms.json#FRAME". Throws InputError.
std::unique_ptr<Selector> select_view(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
