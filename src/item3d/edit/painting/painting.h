// Edits by methods that paint texels view after view (baselines/view_painter.h), in place of the
// neural texture's loop.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/field/bake/bake.h"

namespace item3d {

/// Returns a state with a painter before its first step. When the request resumes and the output
/// folder has a checkpoint, the state comes from the checkpoint. scene.atlas must have its UVs.
EditState begin_painting(const EditRequest& request, const EditScene& scene);

/// Runs the remaining steps; writes checkpoints, previews and each view as views/NN.png. Throws
/// Interrupted after writing the checkpoint.
void paint_views(const EditRequest& request, const EditScene& scene, EditState& state);

/// Returns the file of a painted view, relative to the output folder.
std::string painted_view_file(std::size_t index);

}  // namespace item3d
