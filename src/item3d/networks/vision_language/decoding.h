// Greedy and beam search over a language model's next tokens, as transformers' generate() does them
// without sampling.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// A language model somewhere in the middle of some texts, one a row.
class LanguageModelState {
  public:
    virtual ~LanguageModelState() = default;
    /// Reads tokens [N, S] int64 behind what was read before; returns the logits [N, V] float32 of
    /// what follows the last of them.
    virtual at::Tensor read(const at::Tensor& tokens) = 0;
    /// Row i goes on as a copy of row rows[i]; rows [M] int64.
    virtual void select(const at::Tensor& rows) = 0;
};

struct DecodingOptions {
    int max_new_tokens = 20;
    int beams = 1;  ///< 1: greedy
    int end_token = 0;
    int pad_token = 0;
    double length_penalty = 1;  ///< of beams: scores are divided by length^penalty
    /// One text for all rows: each token is chosen by the mean of the rows' log-probabilities, as a
    /// product of experts. The rows must begin with the same tokens.
    bool together = false;
};

struct Decoded {
    /// [N, S + T] int64 (of one row where they are written together): the prompt and what follows.
    /// Rows that ended sooner are filled with pad_token; by beam search with end_token where
    /// pad_token is 0 (transformers takes that for "none").
    at::Tensor tokens;
    at::Tensor scores;  ///< [N] of beams: mean log-probability a new token; else undefined
};

/// prompt [N, S] int64, which `state` has not read yet. Deterministic.
Decoded decode(LanguageModelState& state, const at::Tensor& prompt, const DecodingOptions& options);

}  // namespace item3d
