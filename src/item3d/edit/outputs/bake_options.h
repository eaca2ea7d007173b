// Options of the bake, from an edit's plan.
#pragma once

#include "item3d/edit/plan.h"
#include "item3d/field/bake/bake.h"

namespace item3d {

/// channels: the edited ones.
BakeOptions bake_options(const EditPlan& plan, const ChannelMask& channels);

/// Returns the policy for the UV maps that the bake uses.
UvPolicy baked_uvs(const EditPlan& plan);

}  // namespace item3d
