// A step of Adam (Kingma and Ba 2015, algorithm 1) for one row of a parameter, with gradient g:
//
//     momentum <- beta1 momentum + (1 - beta1) g      variance <- beta2 variance + (1 - beta2) g^2
//     parameter <- parameter - factor rate momentum' / (sqrt(variance') + epsilon)
//     momentum' = momentum / (1 - beta1^t)              variance' = variance / (1 - beta2^t)
//
// t counts the row's own updates, so that a row whose first gradient comes late takes a full first
// step. Rows without a gradient are not changed. The arrays are:
//
//     parameter, momentum, variance  [*, width]        updates, row_factors  [*]
//     gradient  [R, width] of the rows `rows` [R]       rates  [largest t + 1]
#pragma once

#include "item3d/core/host_device.h"

#include <cmath>
#include <cstdint>

namespace item3d {

/// The coefficients of one step, with the bias corrections.
struct AdamRates {
    float beta1, beta2, epsilon;
    float step_size;       ///< learning_rate / (1 - beta1^t)
    float variance_scale;  ///< 1 / (1 - beta2^t)
};

struct AdamParameters {
    const std::int64_t* rows;  ///< [R] distinct rows of the parameter; null: all rows in order
    const float* gradient;     ///< [R, width]
    std::int64_t width;
    float* parameter;          ///< [*, width]
    float* momentum;           ///< [*, width]
    float* variance;           ///< [*, width]
    std::int32_t* updates;     ///< [*]
    const float* row_factors;  ///< [*] factors of the step size; null: all factors are 1
    const AdamRates* rates;    ///< indexed by the row's number of updates, this one included
};

ITEM3D_HOST_DEVICE inline void adam_update(float& parameter, float& momentum, float& variance,
                                           float gradient, const AdamRates& rates, float factor) {
    momentum = rates.beta1 * momentum + (1.0f - rates.beta1) * gradient;
    variance = rates.beta2 * variance + (1.0f - rates.beta2) * gradient * gradient;
    parameter -= factor * rates.step_size * momentum /
                 (std::sqrt(variance * rates.variance_scale) + rates.epsilon);
}

/// Does the step for one row. index: row of the gradient.
ITEM3D_HOST_DEVICE inline void adam_step_row(const AdamParameters& p, std::int64_t index) {
    const std::int64_t row = p.rows != nullptr ? p.rows[index] : index;
    const AdamRates& rates = p.rates[++p.updates[row]];
    const float factor = p.row_factors != nullptr ? p.row_factors[row] : 1.0f;
    for (std::int64_t c = 0; c < p.width; ++c) {
        const std::int64_t at = row * p.width + c;
        adam_update(p.parameter[at], p.momentum[at], p.variance[at],
                    p.gradient[index * p.width + c], rates, factor);
    }
}

}  // namespace item3d
