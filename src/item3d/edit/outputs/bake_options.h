// The options of the bake that follow from an edit's plan.
#pragma once

#include "item3d/edit/plan.h"
#include "item3d/field/bake/bake.h"

namespace item3d {

/// Returns the options. channels: the edited channels.
BakeOptions bake_options(const EditPlan& plan, const ChannelMask& channels);

/// Returns the policy for UV maps that the bake follows.
UvPolicy baked_uvs(const EditPlan& plan);

}  // namespace item3d
