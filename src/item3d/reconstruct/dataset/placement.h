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
    std::string words;   ///< "turned by 90 degrees about x, then ..."; empty: identity
    double overlap = 0;  ///< intersection over union of the placed mesh's outlines and the masks

    Mat4 matrix() const;
};

/// Rotation about the origin; words: "90 degrees about x", empty for the identity.
struct NamedTurn {
    Mat3 matrix;
    std::string words;
};

/// Returns the 24 rotations that map axes to axes, as one rotation about x, y or z, or two in
/// sequence. Adds world_from_dataset if it is none of these.
std::vector<NamedTurn> turns_to_try(const Mat3& world_from_dataset);

struct NamedScale {
    float factor;
    std::string words;  ///< "0.01 (centimetres in metres)"
};

/// Returns the scale factors between common units of length that differ from `about` by less than a
/// tenth, the nearest first.
std::vector<NamedScale> scales_near(float about);

/// Returns "turned by TURN, scaled by SCALE, then moved by (...)" with only the parts that differ
/// from the identity by more than a fiftieth. size: the move is compared in units of this length.
std::string placement_words(const Placement& placement, const std::string& turn,
                            const std::string& scale, float size);

}  // namespace item3d
