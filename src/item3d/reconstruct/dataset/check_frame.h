// Check of a given mesh's placement against the photographs.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/dataset/placement.h"
#include "item3d/reconstruct/shape/clean_mesh.h"

#include <string>

namespace item3d {

struct FrameFit {
    double overlap = 0;    ///< intersection over union of outlines and masks, before any placement
    double agreement = 0;  ///< overlap with a tolerance of little more than a pixel
    double masks_covered = 0;  ///< fraction of the masks' area that the outlines cover
    bool fits = false;
    /// True if the mesh covers the masks and more. Such a mesh may be right, because a material's
    /// opacity may cut out the parts outside the masks.
    bool may_be_cut_out = false;
    Placement best;  ///< best placement found; identity if the mesh fits
    bool best_fits = false;
};

/// Compares the mesh's outlines with the masks of a few training views. If they overlap too little,
/// the function tries four kinds of placement in turn until one fits. The first kind is a rotation
/// of turns_to_try() about the origin. The second adds a conversion of units, such as from
/// millimetres to metres. The third adds any scale factor instead. The fourth adds any scale factor
/// and a move of the mesh to the masks' visual hull.
FrameFit fit_frame(const TriangleMesh& mesh, const Dataset& dataset);

/// Checks whether the mesh's frame is that of the photographs. If not, throws InputError that
/// begins with `file`, the mesh's name, and says how to place the mesh. Returns a warning, or "" if
/// there is none.
std::string check_mesh_frame(const TriangleMesh& mesh, const Dataset& dataset,
                             const std::string& file);

/// Returns the transform that aligns the mesh with the photographs to within about a pixel. Its
/// `words` are empty if the mesh fits as it is. Throws InputError like check_mesh_frame() if no
/// transform is found.
Placement place_mesh(const TriangleMesh& mesh, const Dataset& dataset, const std::string& file);

}  // namespace item3d
