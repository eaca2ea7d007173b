// What an edit's plan says of its bake.
#pragma once

#include "item3d/edit/plan.h"
#include "item3d/field/bake/bake.h"

namespace item3d {

/// channels: those that the edit changed.
BakeOptions bake_options(const EditPlan& plan, const ChannelMask& channels);

/// Which UV maps are baked into.
UvPolicy baked_uvs(const EditPlan& plan);

}  // namespace item3d
