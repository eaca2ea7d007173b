// Refinement of slightly inexact poses by outlines alone.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/shape/clean_mesh.h"
#include "item3d/reconstruct/surface/view_corrections.h"

#include <string>

namespace item3d {

/// Moves all cameras if the option is PoseRefinement::refine, or if it is `automatic` and the
/// images' outlines are inconsistent. Alternates two steps: the first computes the hull that most
/// outlines allow, the second moves each camera so that the hull's outline matches the mask.
/// Returns the final VisualHull::disagreement(). Throws InputError that begins with `subject` if no
/// point is inside the masks.
double align_to_hull(const Dataset& dataset, const std::string& subject,
                     ViewCorrections& corrections);

/// Returns `views` with cameras moved so that the mesh's outlines match the masks. The result
/// serves to score held-out views, whose poses are as inexact as those of the training views.
std::vector<Photograph> aligned_to_mesh(const TriangleMesh& mesh, const Dataset& dataset,
                                        const std::vector<Photograph>& views);

}  // namespace item3d
