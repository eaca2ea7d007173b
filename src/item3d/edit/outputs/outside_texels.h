// The count of texels that an edit of a region changed outside of the region.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/scene/model.h"

#include <cstdint>

namespace item3d {

/// Counts of texels in edited textures whose weight in the region is 0.
struct OutsideTexels {
    std::int64_t compared = 0;
    std::int64_t changed = 0;  ///< compared texels whose bits differ from the source's
};

/// Compares the edited model, as read back, with its source. Skips textures that the source lacks,
/// that have a factor other than 1, or whose size has changed.
OutsideTexels compare_outside(const EditScene& scene, const Model& edited);

}  // namespace item3d
