// Refinement of slightly inexact poses by outlines alone.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/shape/clean_mesh.h"
#include "item3d/reconstruct/surface/view_corrections.h"

#include <string>

namespace item3d {

/// Moves all cameras if the images' outlines are inconsistent, by alternation: the hull that most
/// outlines allow, then for each view the motion that aligns its outline with the mask. Poses to be
/// kept stay. Returns the final VisualHull::disagreement(). Throws InputError that begins with
/// `subject` if nothing is inside the masks.
double align_to_hull(const Dataset& dataset, const std::string& subject,
                     ViewCorrections& corrections);

/// Returns `views` with cameras that align the mesh's outlines with their masks, for scores of
/// held-out views, whose poses are as inexact.
std::vector<Photograph> aligned_to_mesh(const TriangleMesh& mesh, const Dataset& dataset,
                                        const std::vector<Photograph>& views);

}  // namespace item3d
