// An edit by a method that paints texels view after view (baselines/view_painter.h), in place of
// the neural texture's loop.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/field/bake/bake.h"

namespace item3d {

/// The painter before its first step, or as the checkpoint in the output folder has it when the
/// request says resume and one is there. scene.atlas must have its UVs.
EditState begin_painting(const EditRequest& request, const EditScene& scene);

/// Takes the remaining steps; checkpoints and previews as it goes, each view as views/NN.png.
/// Throws Interrupted after writing the checkpoint.
void paint_views(const EditRequest& request, const EditScene& scene, EditState& state);

/// The file of a painted view, relative to the output folder.
std::string painted_view_file(std::size_t index);

}  // namespace item3d
