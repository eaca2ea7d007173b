// Whether a given mesh stands where the photographs show the object.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/shape/clean_mesh.h"

#include <string>

namespace item3d {

/// A change of a mesh's place: position -> scale * turn * position + move.
struct Placement {
    Mat3 turn{1.0f};
    float scale = 1;
    Vec3 move{0.0f};
    std::string words;   ///< "turned by 90 degrees about x, then ..."; empty: as it is
    double overlap = 0;  ///< of its outlines with the masks: intersection over union
};

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

/// Compares outlines in a few training views. Where they do not overlap, tries the 24 turns that
/// bring axes to axes and the one from the dataset's own world, first about the origin, then with
/// the box's middle where the hull's is and one factor in all directions.
FrameFit fit_frame(const TriangleMesh& mesh, const Dataset& dataset);

/// Throws InputError that begins with `file`, the mesh's name, and says how to place it where it is
/// in another frame than the photographs. Returns a warning, or nothing where all is well.
std::string check_mesh_frame(const TriangleMesh& mesh, const Dataset& dataset,
                             const std::string& file);

}  // namespace item3d
