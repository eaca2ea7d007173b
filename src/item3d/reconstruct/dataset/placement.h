// Changes of a mesh's place that people forget: turns of the axes, other units.
#pragma once

#include "item3d/core/math.h"

#include <string>
#include <vector>

namespace item3d {

/// position -> scale * turn * position + move.
struct Placement {
    Mat3 turn{1.0f};
    float scale = 1;
    Vec3 move{0.0f};
    std::string words;   ///< "turned by 90 degrees about x, then ..."; empty: as it is
    double overlap = 0;  ///< of its outlines with the masks: intersection over union

    Mat4 matrix() const;
};

/// A turn about the origin; words: "90 degrees about x", empty for none.
struct NamedTurn {
    Mat3 matrix;
    std::string words;
};

/// The 24 that bring axes to axes, as one turn about x, y or z, or two one after the other; and the
/// dataset's own world where that is another one.
std::vector<NamedTurn> turns_to_try(const Mat3& world_from_dataset);

struct NamedScale {
    float factor;
    std::string words;  ///< "0.01 (centimetres in metres)"
};

/// Factors between units that meshes are made in, all within a tenth of `about`, the nearest first.
std::vector<NamedScale> scales_near(float about);

/// "turned by TURN, scaled by SCALE, then moved by (...)" of what differs from nothing by more than
/// a fiftieth; size: what a move is measured by.
std::string placement_words(const Placement& placement, const std::string& turn,
                            const std::string& scale, float size);

}  // namespace item3d
