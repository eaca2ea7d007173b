// Functions for a process's share of the surface points in images.
#pragma once

#include "item3d/edit/material_source.h"
#include "item3d/processes/process_group.h"
#include "item3d/render/interpolate.h"

namespace item3d {

/// Returns the rows `points` of `all`.
Surface narrow(const Surface& all, const Share& points);
MaterialSample narrow(const MaterialSample& all, const Share& points);
OwnMaterial narrow(const OwnMaterial& all, const Share& points);

}  // namespace item3d
