// Selectors by painted images.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// Selects by an image in UV space, "FILE" or "FILE@MATERIAL". The weight is the image's luminance
/// times alpha at the coordinates of the first UV map. The image repeats beyond [0, 1]. It applies
/// to all materials with UVs, or to MATERIAL alone. Prints a note if its size differs from the
/// texture's. Throws InputError, also if the image selects nothing.
std::unique_ptr<Selector> select_mask(const SelectorText& text, const RegionScene& scene);

/// Selects by a painted render of the model, "FILE" or "FILE@CAMERA". The weight is the image's
/// luminance times alpha, on visible surfaces that face its camera. CAMERA is "AZIMUTH,ELEVATION"
/// in degrees, framed as in `item3d render`, or a transforms.json, or "transforms.json#FRAME".
/// Throws InputError.
std::unique_ptr<Selector> select_view(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
