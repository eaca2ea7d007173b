// Edits by methods that paint texels view after view (baselines/view_painter.h). They have no
// neural texture and no optimisation loop.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/field/bake/bake.h"

namespace item3d {

/// Returns a state with a painter. If the request resumes and the output folder has a checkpoint,
/// the state is that of the checkpoint, else the painter is before its first step. scene.atlas must
/// have its UVs.
EditState begin_painting(const EditRequest& request, const EditScene& scene);

/// Runs the remaining steps. Writes checkpoints, previews and each view as views/NN.png. If
/// interrupted, writes the checkpoint and throws Interrupted.
void paint_views(const EditRequest& request, const EditScene& scene, EditState& state);

/// Returns the file of a painted view, relative to the output folder.
std::string painted_view_file(std::size_t index);

}  // namespace item3d
