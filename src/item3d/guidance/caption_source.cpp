#include "item3d/guidance/caption_source.h"

#include "item3d/core/error.h"
#include "item3d/core/words.h"

#include <algorithm>
#include <array>

namespace item3d {
namespace {

constexpr double weight_without_object = 0.25;

bool is_small_word(const std::string& word) {
    static constexpr std::array small = {"a",   "an", "and", "at", "by",   "for",  "from",
                                         "in",  "is", "it",  "of", "on",   "or",   "some",
                                         "the", "to", "two", "up", "with", "that", "this"};
    return std::find(small.begin(), small.end(), word) != small.end();
}

bool contains(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

std::vector<std::string> object_words(const std::string& source_prompt,
                                      const std::string& target_prompt) {
    std::vector<std::string> source = prompt_words(source_prompt);
    std::erase_if(source, is_small_word);
    const std::vector<std::string> target = prompt_words(target_prompt);
    std::vector<std::string> shared = source;
    std::erase_if(shared, [&](const std::string& word) { return !contains(target, word); });
    return shared.empty() ? source : shared;
}

bool mentions(const std::string& caption, const std::vector<std::string>& words) {
    const std::vector<std::string> said = prompt_words(caption);
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
        return contains(said, word) || contains(said, word + "s") || contains(said, word + "es");
    });
}

CaptionSource::CaptionSource(std::shared_ptr<const DiffusionModel> pipeline,
                             const std::string& source_prompt, const std::string& target_prompt,
                             const CaptionSourceOptions& options)
    : pipeline_(std::move(pipeline)),
      options_(options),
      object_words_(object_words(source_prompt, target_prompt)) {
    const TextEmbedding text = pipeline_->encode_text({target_prompt, source_prompt});
    direction_ = add_scaled(text.row(0), text.row(1), -1);
}

double CaptionSource::weight(const Caption& before, const Caption& now) const {
    for (const Caption* caption : {&before, &now})
        if (!caption->ended || prompt_words(caption->text).empty()) return 0;
    const bool both = mentions(before.text, object_words_) && mentions(now.text, object_words_);
    return both ? 1 : weight_without_object;
}

std::optional<TextEmbedding> CaptionSource::shift(const std::vector<Caption>& before,
                                                  const std::vector<Caption>& now) const {
    ITEM3D_CHECK(!now.empty() && before.size() == now.size(), "captions of the same views");
    const at::NoGradGuard no_grad;
    const double share = 1.0 / static_cast<double>(now.size());
    TextEmbedding sum = scaled(direction_, 0);
    bool useful = false;
    for (std::size_t i = 0; i < now.size(); ++i) {
        const double counts = weight(before[i], now[i]);
        if (counts == 0) continue;
        useful = true;
        if (before[i].text == now[i].text) continue;
        const TextEmbedding text = pipeline_->encode_text({now[i].text, before[i].text});
        sum = add_scaled(sum, add_scaled(text.row(0), text.row(1), -1), counts * share);
    }
    if (!useful) return std::nullopt;

    const double wanted = options_.strength * length_of(sum), maximum = length_of(direction_);
    const double bound = wanted > maximum ? maximum / wanted : 1;
    const double sign = options_.paper_sign ? -1 : 1;
    return scaled(sum, sign * options_.strength * bound);
}

}  // namespace item3d
