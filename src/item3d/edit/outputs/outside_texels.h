// A count of what an edit of a region changed outside of it.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/scene/model.h"

#include <cstdint>

namespace item3d {

/// Texels of edited textures whose weight in the region is 0.
struct OutsideTexels {
    std::int64_t compared = 0;
    std::int64_t changed = 0;  ///< of those, not the source's to the bit
};

/// edited: the model as it was read back. Textures that the source lacks, that are multiplied by a
/// factor, or have another size now, have no texels to compare.
OutsideTexels compare_outside(const EditScene& scene, const Model& edited);

}  // namespace item3d
