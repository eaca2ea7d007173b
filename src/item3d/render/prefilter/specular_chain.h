// A prefiltered chain in the layout of the shading kernels.
//
//     scale[first][i] = 1 / prod_(j != i) (x_i - x_j)      x: log roughness of levels first to
//                                                          first + 3
//
// of Lagrange's cubic sum_i P_i scale_i prod_(j != i) (x - x_j), which is computed for each pixel.
#pragma once

#include "item3d/render/kernels/shade.h"
#include "item3d/tensors/tensor.h"

#include <cmath>
#include <vector>

namespace item3d {

/// maps: [6, S, S, 3] each, at least four, which must outlive the parameters; roughness: ascending.
inline void set_specular_chain(kernels::ShadeParameters& parameters,
                               const std::vector<at::Tensor>& maps,
                               const std::vector<float>& roughness) {
    parameters.levels = static_cast<int>(maps.size());
    for (std::size_t level = 0; level < maps.size(); ++level) {
        parameters.specular[level] = maps[level].const_data_ptr<float>();
        parameters.specular_size[level] = static_cast<int>(maps[level].size(1));
        parameters.specular_log_roughness[level] = std::log(roughness[level]);
    }
    for (int first = 0; first + 4 <= parameters.levels; ++first) {
        const float* nodes = parameters.specular_log_roughness + first;
        for (int i = 0; i < 4; ++i) {
            float product = 1;
            for (int j = 0; j < 4; ++j)
                if (j != i) product *= nodes[i] - nodes[j];
            parameters.specular_scale[first][i] = 1 / product;
        }
    }
}

}  // namespace item3d
