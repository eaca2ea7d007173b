// Candidate placements of a mesh: rotations that map axes to axes, and scale factors between units
// of length.
#pragma once

#include "item3d/core/math.h"

#include <string>
#include <vector>

namespace item3d {

/// Similarity transform: position -> scale * turn * position + move.
struct Placement {
    Mat3 turn{1.0f};
    float scale = 1;
    Vec3 move{0.0f};
    std::string words;   ///< "turned by 90 degrees about x, then ..."; empty for the identity
    double overlap = 0;  ///< intersection over union of the placed mesh's outlines and the masks

    Mat4 matrix() const;
};

/// Rotation about the origin. `words` are such as "90 degrees about x"; they are empty for the
/// identity.
struct NamedTurn {
    Mat3 matrix;
    std::string words;
};

/// Returns the 24 rotations that map axes to axes. Each is described as one rotation about x, y or
/// z, or as two in sequence. Adds world_from_dataset if it is not among them.
std::vector<NamedTurn> turns_to_try(const Mat3& world_from_dataset);

struct NamedScale {
    float factor;
    std::string words;  ///< "0.01 (centimetres in metres)"
};

/// Returns the scale factors between common units of length that differ from `about` by less than a
/// tenth, the nearest first.
std::vector<NamedScale> scales_near(float about);

/// Returns "turned by TURN, scaled by SCALE, then moved by (...)" with only the parts that differ
/// from the identity by more than a fiftieth. size: unit of length in which the move is compared.
std::string placement_words(const Placement& placement, const std::string& turn,
                            const std::string& scale, float size);

}  // namespace item3d
