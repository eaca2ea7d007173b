// What a linear layer's sums can go through.
#pragma once

namespace item3d {

enum class LinearActivation {
    none,
    gelu,        ///< x Phi(x), Hendrycks and Gimpel 2016
    quick_gelu,  ///< x / (1 + e^(-1.702 x)), CLIP's
};

}  // namespace item3d
