// Poses that are a little off, found by the outlines alone.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/shape/clean_mesh.h"
#include "item3d/reconstruct/surface/view_corrections.h"

#include <string>

namespace item3d {

/// Where the outlines of the pictures do not agree with each other, moves all cameras so that they
/// do, in turns: the hull that most outlines allow, then, for each view, the motion that brings its
/// outline to the mask. Poses that are kept stay. Returns VisualHull::disagreement() in the end.
/// Throws InputError that begins with `subject` where nothing is inside the
/// masks.
double align_to_hull(const Dataset& dataset, const std::string& subject,
                     ViewCorrections& corrections);

/// `views` with the cameras that bring the mesh's outlines to their masks: what a held-out view of
/// such a dataset is compared by, because its pose is as far off.
std::vector<Photograph> aligned_to_mesh(const TriangleMesh& mesh, const Dataset& dataset,
                                        const std::vector<Photograph>& views);

}  // namespace item3d
