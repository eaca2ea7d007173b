// A prefiltered chain in the layout of the shading kernels.
//
//     scale[first][i] = 1 / prod_(j != i) (x_i - x_j)      x: log roughness of levels first to
//                                                          first + 3
//
// are the factors of Lagrange's cubic sum_i P_i scale_i prod_(j != i) (x - x_j), which is computed
// for each pixel.
#pragma once

#include "item3d/render/kernels/shade.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace item3d {

/// One lobe of a chain.
struct SpecularLevel {
    const float* map;  ///< [6, S, S, 3]
    int size;          ///< S
    float roughness;
};

/// Returns the levels of maps [6, S, S, 3], one tensor for each level. Tensor: LibTorch's class or
/// the class of its stable ABI. roughness: one value for each map.
template <typename Tensor>
std::vector<SpecularLevel> specular_levels_of(const std::vector<Tensor>& maps,
                                              const float* roughness) {
    std::vector<SpecularLevel> levels;
    for (const Tensor& map : maps)
        levels.push_back({static_cast<const float*>(map.const_data_ptr()),
                          static_cast<int>(map.size(1)), roughness[levels.size()]});
    return levels;
}

/// Sets the chain of the shading kernels. levels: at least four, of ascending roughness. The
/// levels' maps must outlive `parameters`.
inline void set_specular_chain(kernels::ShadeParameters& parameters,
                               const std::vector<SpecularLevel>& levels) {
    parameters.levels = static_cast<int>(levels.size());
    for (std::size_t i = 0; i < levels.size(); ++i) {
        parameters.specular[i] = levels[i].map;
        parameters.specular_size[i] = levels[i].size;
        parameters.specular_log_roughness[i] = std::log(levels[i].roughness);
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
