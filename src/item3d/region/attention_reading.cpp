#include "item3d/region/attention_reading.h"

#include "item3d/core/error.h"
#include "item3d/guidance/reading.h"

#include <algorithm>

namespace item3d {
namespace {

/// Number of noise draws in the mean attention.
constexpr int attention_noises = 4;

}  // namespace

std::string attention_prompt(const std::string& words) {
    std::string text = words;
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    for (const std::string article : {"the ", "an ", "a "}) {
        if (!text.starts_with(article)) continue;
        text = text.substr(article.size());
        break;
    }
    return "the " + text;
}

at::Tensor share_of_words(const at::Tensor& attention, std::int64_t tokens) {
    ITEM3D_CHECK(attention.dim() == 3 && tokens >= 2 && attention.size(0) > tokens,
                 "attention to an article and words");
    const at::Tensor all = attention.slice(0, 1, 1 + tokens).sum(0, true);
    return attention.slice(0, 2, 1 + tokens).sum(0, true) / all.clamp_min(1e-9);
}

SurfaceReading read_attention(const RegionScene& scene, const DiffusionModel& prior,
                              const std::string& words) {
    const std::string prompt = attention_prompt(words);
    // Number of tokens after truncation by the prior, without the start and end token.
    const auto tokens =
        std::min<std::int64_t>(static_cast<std::int64_t>(prior.tokenizer().encode(prompt).size()),
                               prior.tokenizer().model_max_length()) -
        2;
    const TextEmbedding text = prior.encode_text({prompt});
    ReadingOptions options;
    options.noises = attention_noises;
    SurfaceReading reading = read_surface(scene, prior.native_size(), [&](const ModelView& view) {
        const GuidanceInput input{view.image.to(prior.device()), view.shape, {}};
        return share_of_words(mean_attention(prior, input, text, options)[0], tokens);
    });
    const at::Tensor seen = reading.values[0].index({reading.seen});
    const double mean = seen.mean().item<double>();
    const double deviation = (seen - mean).square().mean().sqrt().item<double>();
    reading.values = (reading.values - mean) / std::max(deviation, 1e-9);
    return reading;
}

}  // namespace item3d
