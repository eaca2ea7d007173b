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
    /// of the token that follows `tokens`, where V is the size of the vocabulary.
    virtual at::Tensor read(const at::Tensor& tokens) = 0;
    /// Replaces text i by a copy of text rows[i]; rows [M] int64.
    virtual void select(const at::Tensor& rows) = 0;
};

struct DecodingOptions {
    int max_new_tokens = 20;
    int beams = 1;  ///< 1 for greedy search
    int end_token = 0;
    int pad_token = 0;
    double length_penalty = 1;  ///< for beam search: scores are divided by length^penalty
    /// True for one text for all prompts. Each token is then chosen by the mean of the prompts'
    /// log-probabilities, as in a product of experts. The prompts must consist of the same tokens.
    bool together = false;
};

struct Decoded {
    /// Prompts and their continuations of up to T tokens, [N, S + T] int64 (N = 1 with `together`).
    /// Texts that ended earlier are padded with pad_token. Beam search pads with end_token if
    /// pad_token is 0 (which transformers takes for "none").
    at::Tensor tokens;
    /// [N] mean log-probabilities per new token; undefined for greedy search.
    at::Tensor scores;
};

/// Continues prompt [N, S] int64, which `state` has not read yet. The result is deterministic.
Decoded decode(LanguageModelState& state, const at::Tensor& prompt, const DecodingOptions& options);

}  // namespace item3d
