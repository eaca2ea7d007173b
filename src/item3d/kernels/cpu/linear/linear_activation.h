// The activations of a linear layer.
#pragma once

namespace item3d {

enum class LinearActivation {
    none,
    gelu,        ///< x Phi(x), Hendrycks and Gimpel 2016
    quick_gelu,  ///< x / (1 + e^(-1.702 x)), of CLIP
};

}  // namespace item3d
