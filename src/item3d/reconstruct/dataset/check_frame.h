// Check of a given mesh's placement against the photographs.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/dataset/placement.h"
#include "item3d/reconstruct/shape/clean_mesh.h"

#include <string>

namespace item3d {

struct FrameFit {
    double overlap = 0;    ///< intersection over union of outlines and masks, for the mesh as it is
    double agreement = 0;  ///< overlap with a tolerance of little more than a pixel
    double masks_covered = 0;  ///< fraction of the masks' area that the outlines cover
    bool fits = false;
    /// True if the mesh covers all of the masks and more: a material's opacity may cut out the
    /// rest.
    bool may_be_cut_out = false;
    Placement best;  ///< best placement found; identity if the mesh fits
    bool best_fits = false;
};

/// Compares outlines in a few training views. If they do not overlap, tries in turn, until one
/// fits: the rotations of turns_to_try() about the origin; these with factors between units; these
/// with any factor; and the box's middle moved to the hull's, with any factor.
FrameFit fit_frame(const TriangleMesh& mesh, const Dataset& dataset);

/// Checks the mesh's frame. Throws InputError that begins with `file`, the mesh's name, and says
/// how to place the mesh if its frame differs from the photographs'. Returns a warning, or "" if
/// there is none.
std::string check_mesh_frame(const TriangleMesh& mesh, const Dataset& dataset,
                             const std::string& file);

/// Returns the transform that aligns the mesh with the photographs, to about a pixel; no words if
/// it fits as it is. Throws InputError like check_mesh_frame() if none is found.
Placement place_mesh(const TriangleMesh& mesh, const Dataset& dataset, const std::string& file);

}  // namespace item3d
