// The normal distribution in SIMD registers, for GELU. Only for files that are compiled for each
// instruction set.
//
//     erf(z) ~ 1 - (a1 t + a2 t^2 + a3 t^3 + a4 t^4 + a5 t^5) e^(-z^2)
//     t = 1 / (1 + 0.3275911 z)
//
// for z >= 0, within 1.5e-7 (Abramowitz and Stegun 1964, 7.1.26). With z = |x| / sqrt(2):
//
//     P(X > |x|) = (1 - erf(z)) / 2 = t (a1 + t (a2 + ..)) e^(-x^2 / 2) / 2
//     density    = e^(-x^2 / 2) / sqrt(2 pi)
//
// So one exponential serves both, and the tail keeps its relative precision far from 0.
#pragma once

#include "item3d/kernels/cpu/simd.h"

namespace item3d::ITEM3D_INSTRUCTIONS {

/// Density and distribution function of a standard normal variable at x.
struct NormalDistribution {
    Lanes density;
    Lanes below;  ///< P(X < x), with an error of at most 7.5e-8
};

ITEM3D_INLINE NormalDistribution normal_distribution(Lanes x) {
    const Lanes z = absolute(x) * all(0.70710678f);
    const Lanes t = all(1) / multiply_add(z, all(0.3275911f), all(1));
    Lanes series = all(1.061405429f);
    for (const float term : {-1.453152027f, 1.421413741f, -0.284496736f, 0.254829592f})
        series = multiply_add(series, t, all(term));
    const Lanes power = exponential(larger(zero() - z * z, all(-87)));
    const Lanes tail = all(0.5f) * t * series * power;  // P(X > |x|)
    return {all(0.39894228f) * power, choose(is_less(x, zero()), tail, all(1) - tail)};
}

/// Returns GELU (Hendrycks & Gimpel 2016) in its exact form.
ITEM3D_INLINE Lanes gelu(Lanes x) {
    return x * normal_distribution(x).below;
}

}  // namespace item3d::ITEM3D_INSTRUCTIONS
