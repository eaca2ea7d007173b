// A source embedding that follows a captioner (--adjust caption; ITEM3D, section 3.4). Symbols:
// guidance.h; e(y) is the embedding of a text y.
//
// In the paper a captioner B describes the render I_i of iteration i, every few iterations. The
// source prompt changes by the difference of successive captions. In the space of embeddings the
// sum of these differences telescopes:
//   e_source,i = e(y_source) + lambda mean_v w_v [ e(B(I_i,v)) - e(B(I_0,v)) ],
//
// where the mean is over a few views v. The paper's formula instead adds the sum to the direction,
// which is target minus source. That has the opposite sign, and `paper_sign` selects it.
//
// The weights w_v keep useless captions from doing harm. w_v is 1, but a quarter if one of the two
// captions does not mention the object, and 0 if one is empty or was cut off. The shift is at most
// as long as e(y_target) - e(y_source).
#pragma once

#include "item3d/guidance/text_direction.h"
#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/vision_language/captioner.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct CaptionSourceOptions {
    float strength = 1;  ///< lambda
    bool paper_sign = false;
};

/// Returns the words that name the object, in lower case. These are the words in both sentences, or
/// all words of the source if no word is in both, without "a", "of" and the like.
std::vector<std::string> object_words(const std::string& source_prompt,
                                      const std::string& target_prompt);

/// True if one of these words, or its plural, is in the caption.
bool mentions(const std::string& caption, const std::vector<std::string>& words);

class CaptionSource {
  public:
    CaptionSource(std::shared_ptr<const DiffusionModel> pipeline, const std::string& source_prompt,
                  const std::string& target_prompt, const CaptionSourceOptions& options);

    /// Returns the shift of the source prompt's embedding (one row). before, now: captions of the
    /// same views before the edit and in this iteration. Returns no value if no view has usable
    /// captions.
    std::optional<TextEmbedding> shift(const std::vector<Caption>& before,
                                       const std::vector<Caption>& now) const;

  private:
    double weight(const Caption& before, const Caption& now) const;

    std::shared_ptr<const DiffusionModel> pipeline_;
    CaptionSourceOptions options_;
    std::vector<std::string> object_words_;
    TextEmbedding direction_;  ///< e(y_target) - e(y_source)
};

}  // namespace item3d
