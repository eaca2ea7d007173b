// Cache of a decoder's keys and values, so that those of each token are computed once.
#pragma once

#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Keys and values of one attention layer.
struct KeyValues {
    at::Tensor keys, values;  ///< [N, T, C]; undefined before the first token

    /// Appends the keys and values of new tokens [N, S, C].
    void append(const at::Tensor& more_keys, const at::Tensor& more_values) {
        keys = keys.defined() ? at::cat({keys, more_keys}, 1) : more_keys;
        values = values.defined() ? at::cat({values, more_values}, 1) : more_values;
    }
    std::int64_t length() const { return keys.defined() ? keys.size(1) : 0; }
};

/// Keys and values of all layers of a decoder.
struct KeyValueCache {
    std::vector<KeyValues> layers;

    std::int64_t length() const { return layers.empty() ? 0 : layers.front().length(); }
    /// Replaces sequence i of the batch by the former sequence rows[i].
    void select(const at::Tensor& rows) {
        for (KeyValues& layer : layers) {
            layer.keys = layer.keys.index_select(0, rows);
            layer.values = layer.values.index_select(0, rows);
        }
    }
};

/// Returns an additive mask [N, 1, S, T] float32. Token s, which is token T - S + s of its whole
/// sequence, sees itself and earlier tokens whose `visible` [N, T] is not 0. Hidden tokens get a
/// large finite negative number, so that a padding token, which sees no token, stays finite.
at::Tensor causal_mask(const at::Tensor& visible, std::int64_t new_tokens);

}  // namespace item3d
