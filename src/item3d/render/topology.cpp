#include "item3d/render/topology.h"

#include "item3d/render/checks.h"
#include "item3d/render/neighbours.h"

#include <vector>

namespace item3d {

at::Tensor triangle_neighbours(const at::Tensor& positions_, const at::Tensor& triangles_) {
    const at::Tensor positions =
        checked("triangle_neighbours", "positions", positions_.detach(), at::kFloat, {-1, 3});
    const at::Tensor triangles =
        checked("triangle_neighbours", "triangles", triangles_, at::kInt, {-1, 3});
    // Adding zero turns -0 into 0, which has other bits.
    const at::Tensor unsigned_zeros = positions + 0.0f;
    const std::vector<std::int32_t> merged =
        merge_by_position(unsigned_zeros.const_data_ptr<float>(), positions.size(0));
    at::Tensor neighbours = at::empty_like(triangles);
    find_neighbours(triangles.const_data_ptr<std::int32_t>(), triangles.size(0), merged.data(),
                    neighbours.data_ptr<std::int32_t>());
    return neighbours;
}

}  // namespace item3d
