// Keys and values of the tokens that a decoder has read, so that each is computed once.
#pragma once

#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Of one attention layer.
struct KeyValues {
    at::Tensor keys, values;  ///< [N, T, C]; undefined before the first token

    /// Appends those of new tokens [N, S, C].
    void append(const at::Tensor& more_keys, const at::Tensor& more_values) {
        keys = keys.defined() ? at::cat({keys, more_keys}, 1) : more_keys;
        values = values.defined() ? at::cat({values, more_values}, 1) : more_values;
    }
    std::int64_t length() const { return keys.defined() ? keys.size(1) : 0; }
};

/// Of all layers of a decoder.
struct KeyValueCache {
    std::vector<KeyValues> layers;

    std::int64_t length() const { return layers.empty() ? 0 : layers.front().length(); }
    /// Row i becomes what row rows[i] was.
    void select(const at::Tensor& rows) {
        for (KeyValues& layer : layers) {
            layer.keys = layer.keys.index_select(0, rows);
            layer.values = layer.values.index_select(0, rows);
        }
    }
};

/// Additive [N, 1, S, T] float32: token s, the (T - S + s)th of its row, sees those up to itself
/// whose `visible` [N, T] is not 0. What it does not see gets a large finite number, so that a
/// padding token, which sees nothing, stays finite.
at::Tensor causal_mask(const at::Tensor& visible, std::int64_t new_tokens);

}  // namespace item3d
