#include "item3d/networks/vision_language/decoding.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"

#include <cmath>

namespace item3d {
namespace {

/// A log-probability far below any that occurs.
constexpr double impossible = -1e9;

void stop_if_interrupted() {
    if (interrupted()) throw Interrupted("while generating text");
}

Decoded greedy_search(LanguageModelState& state, const at::Tensor& prompt,
                      const DecodingOptions& options) {
    at::Tensor tokens = prompt, next = prompt;
    at::Tensor ended = at::zeros({prompt.size(0)}, at::kBool);
    for (int i = 0; i < options.max_new_tokens && !ended.all().item<bool>(); ++i) {
        stop_if_interrupted();
        next = state.read(next).cpu().argmax(-1);
        next = next.masked_fill(ended, options.pad_token).unsqueeze(1);
        ended = ended | next.squeeze(1).eq(options.end_token);
        tokens = at::cat({tokens, next}, 1);
    }
    return {tokens, {}};
}

/// The `beams` best running and the `beams` best ended texts of each prompt. There are N prompts
/// and B beams.
class BeamSearch {
  public:
    BeamSearch(const at::Tensor& prompt, const DecodingOptions& options)
        : options_(options),
          rows_(prompt.size(0)),
          prompt_length_(prompt.size(1)),
          length_(prompt_length_) {
        const int fill = options.pad_token != 0 ? options.pad_token : options.end_token;
        running_ =
            at::full({rows_, options.beams, length_ + options.max_new_tokens}, fill, at::kLong);
        running_.narrow(2, 0, length_).copy_(prompt.unsqueeze(1));
        ended_ = running_.clone();
        running_scores_ = at::full({rows_, options.beams}, impossible, at::kFloat);
        // All texts are copies of the prompt, so only one continues.
        running_scores_.select(1, 0).fill_(0);
        ended_scores_ = at::full({rows_, options.beams}, impossible, at::kFloat);
        ended_lengths_ = at::full({rows_, options.beams}, length_, at::kLong);
        has_ended_ = at::zeros({rows_, options.beams}, at::kBool);
        improves_ = at::ones({rows_, 1}, at::kBool);
    }

    /// Takes the logits [N * B, V] of the next token. Returns, for each new running text, the index
    /// (of N * B) of the text that it continues.
    at::Tensor advance(const at::Tensor& logits) {
        const std::int64_t beams = options_.beams, vocabulary = logits.size(1);
        const at::Tensor scores =
            logits.cpu().to(at::kFloat).log_softmax(-1).view({rows_, beams, vocabulary}) +
            running_scores_.unsqueeze(2);
        // The best 2 * beams candidates are taken: even if `beams` of them end, as many continue.
        const auto [best, index] = scores.view({rows_, -1}).topk(2 * beams, 1);
        const at::Tensor beam = index.floor_divide(vocabulary);
        at::Tensor texts = gather(running_, beam);
        texts.select(2, length_).copy_(index.remainder(vocabulary));
        const bool full = length_ + 1 == running_.size(2);
        const at::Tensor ends = texts.select(2, length_).eq(options_.end_token) | full;

        const auto [kept_scores, kept] = (best + impossible * ends.to(at::kFloat)).topk(beams, 1);
        keep_ended(texts, best, ends);
        running_ = gather(texts, kept);
        running_scores_ = kept_scores;
        ++length_;
        goes_on_ = !full && !ends.all().item<bool>() && may_improve();
        return (beam.gather(1, kept) + at::arange(rows_).unsqueeze(1) * beams).view({-1});
    }

    bool goes_on() const { return goes_on_; }
    /// Returns the last token of each text, [N * B, 1].
    at::Tensor last_tokens() const { return running_.select(2, length_ - 1).reshape({-1, 1}); }

    Decoded result() const {
        const at::Tensor lengths = ended_lengths_.select(1, 0);
        return {ended_.select(1, 0).narrow(1, 0, lengths.max().item<std::int64_t>()).contiguous(),
                ended_scores_.select(1, 0)};
    }

  private:
    static at::Tensor gather(const at::Tensor& texts, const at::Tensor& beam) {
        return texts.gather(1, beam.unsqueeze(2).expand({-1, -1, texts.size(2)}));
    }

    /// Merges the ended texts among the best `beams` candidates into ended_.
    void keep_ended(const at::Tensor& texts, const at::Tensor& best, const at::Tensor& ends) {
        const auto among_best = at::arange(best.size(1)).lt(options_.beams).unsqueeze(0);
        const at::Tensor counts = ends & among_best;
        const double scale =
            std::pow(static_cast<double>(length_ + 1 - prompt_length_), options_.length_penalty);
        const at::Tensor no = (~counts).to(at::kFloat) + (~improves_).to(at::kFloat);
        const at::Tensor scores = at::cat({ended_scores_, best / scale + impossible * no}, 1);
        const auto [top, index] = scores.topk(options_.beams, 1);
        ended_ = gather(at::cat({ended_, texts}, 1), index);
        has_ended_ = at::cat({has_ended_, counts}, 1).gather(1, index);
        ended_lengths_ =
            at::cat({ended_lengths_, at::full_like(texts.select(2, 0), length_ + 1)}, 1)
                .gather(1, index);
        ended_scores_ = top;
    }

    /// True if a running text, at its present score, could still beat an ended one.
    bool may_improve() {
        const double scale =
            std::pow(static_cast<double>(length_ - prompt_length_), options_.length_penalty);
        const at::Tensor worst = at::where(has_ended_, ended_scores_.amin(1, /*keepdim=*/true),
                                           at::full_like(ended_scores_, impossible));
        const at::Tensor possible = running_scores_.narrow(1, 0, 1) / scale;
        improves_ = improves_ & possible.gt(worst).any(1, /*keepdim=*/true);
        return improves_.any().item<bool>();
    }

    const DecodingOptions& options_;
    std::int64_t rows_, prompt_length_, length_;
    at::Tensor running_, ended_;  ///< [N, B, S + T] tokens
    at::Tensor running_scores_;   ///< [N, B] sums of log-probabilities
    at::Tensor ended_scores_;     ///< [N, B] sums divided by length^length_penalty
    at::Tensor ended_lengths_;    ///< [N, B] numbers of tokens, including the prompt's
    at::Tensor has_ended_;        ///< [N, B] true if that entry of ended_ is used
    at::Tensor improves_;         ///< [N, 1] true if a running text of the prompt may still win
    bool goes_on_ = true;
};

/// State of N texts that are read jointly by `readers` texts of another state. Text r * N + i of
/// that state is reader r's copy of text i. The readers' log-probabilities are averaged.
class JointState : public LanguageModelState {
  public:
    JointState(LanguageModelState& state, std::int64_t readers)
        : state_(state), readers_(readers) {}
    at::Tensor read(const at::Tensor& tokens) override {
        texts_ = tokens.size(0);
        return state_.read(tokens.repeat({readers_, 1}))
            .log_softmax(-1)
            .view({readers_, texts_, -1})
            .mean(0);
    }
    void select(const at::Tensor& rows) override {
        const at::Tensor begins = at::arange(readers_).unsqueeze(1) * texts_;
        state_.select((begins + rows).flatten());
        texts_ = rows.size(0);
    }

  private:
    LanguageModelState& state_;
    std::int64_t readers_;
    std::int64_t texts_ = 0;
};

Decoded beam_search(LanguageModelState& state, const at::Tensor& prompt,
                    const DecodingOptions& options) {
    BeamSearch search(prompt, options);
    // Each prompt is read once; its beams begin as copies.
    at::Tensor logits = state.read(prompt);
    const at::Tensor copies = at::arange(prompt.size(0)).repeat_interleave(options.beams);
    logits = logits.cpu().index_select(0, copies);
    state.select(copies);
    while (true) {
        state.select(search.advance(logits));
        if (!search.goes_on()) return search.result();
        stop_if_interrupted();
        logits = state.read(search.last_tokens());
    }
}

}  // namespace

Decoded decode(LanguageModelState& state, const at::Tensor& prompt,
               const DecodingOptions& options) {
    ITEM3D_CHECK(prompt.dim() == 2 && prompt.scalar_type() == at::kLong && prompt.size(1) > 0,
                 "a prompt must be int64 [N, S] with S > 0");
    ITEM3D_CHECK(options.max_new_tokens > 0 && options.beams > 0,
                 "the number of tokens must be above 0");
    const at::NoGradGuard no_grad;
    const auto search = options.beams == 1 ? greedy_search : beam_search;
    if (!options.together) return search(state, prompt, options);
    JointState joint(state, prompt.size(0));
    return search(joint, prompt.narrow(0, 0, 1), options);
}

}  // namespace item3d
