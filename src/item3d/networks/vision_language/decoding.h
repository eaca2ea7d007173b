// Greedy and beam search over a language model's next tokens, as in transformers' generate()
// without sampling.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// State of a language model that has read the beginnings of N texts.
class LanguageModelState {
  public:
    virtual ~LanguageModelState() = default;
    /// Reads tokens [N, S] int64 that follow those read before. Returns the logits [N, V] float32
    /// of the token after the last of them.
    virtual at::Tensor read(const at::Tensor& tokens) = 0;
    /// Replaces text i by a copy of text rows[i]; rows [M] int64.
    virtual void select(const at::Tensor& rows) = 0;
};

struct DecodingOptions {
    int max_new_tokens = 20;
    int beams = 1;  ///< 1: greedy
    int end_token = 0;
    int pad_token = 0;
    double length_penalty = 1;  ///< for beams: scores are divided by length^penalty
    /// One text for all prompts: each token is chosen by the mean of the prompts'
    /// log-probabilities, as in a product of experts. The prompts must consist of the same tokens.
    bool together = false;
};

struct Decoded {
    /// [N, S + T] int64 (N = 1 with `together`): prompts and their continuations. Texts that ended
    /// earlier are padded with pad_token. Beam search pads with end_token if pad_token is 0 (which
    /// transformers takes for "none").
    at::Tensor tokens;
    at::Tensor scores;  ///< [N] of beams: mean log-probability per new token; else undefined
};

/// Continues prompt [N, S] int64, which `state` has not read yet. Deterministic.
Decoded decode(LanguageModelState& state, const at::Tensor& prompt, const DecodingOptions& options);

}  // namespace item3d
