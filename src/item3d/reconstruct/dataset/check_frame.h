// Whether a given mesh stands where the photographs show the object.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/dataset/placement.h"
#include "item3d/reconstruct/shape/clean_mesh.h"

#include <string>

namespace item3d {

struct FrameFit {
    double overlap = 0;        ///< as the mesh is
    double agreement = 0;      ///< the same, but what is off by little more than a pixel is right
    double masks_covered = 0;  ///< part of the masks that its outlines cover
    bool fits = false;
    /// It hides all of the masks, and more: a material's opacity may cut out the rest.
    bool may_be_cut_out = false;
    Placement best;  ///< the same again where it fits
    bool best_fits = false;
};

/// Compares outlines in a few training views. Where they do not overlap, tries, until something
/// fits: the turns of turns_to_try() about the origin; with them the factors between units; with
/// them any factor; and the box's middle where the hull's is, with any factor and moved.
FrameFit fit_frame(const TriangleMesh& mesh, const Dataset& dataset);

/// Throws InputError that begins with `file`, the mesh's name, and says how to place it where it is
/// in another frame than the photographs. Returns a warning, or nothing where all is well.
std::string check_mesh_frame(const TriangleMesh& mesh, const Dataset& dataset,
                             const std::string& file);

/// What brings the mesh to the photographs, to about a pixel; no words where it fits as it is.
/// Throws InputError as check_mesh_frame() does where nothing is found that does.
Placement place_mesh(const TriangleMesh& mesh, const Dataset& dataset, const std::string& file);

}  // namespace item3d
