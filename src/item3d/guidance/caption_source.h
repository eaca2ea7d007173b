// A source embedding that follows a captioner (--adjust caption; ITEM3D, section 3.4).
//
// In the paper a captioner B describes the render I_i every few iterations, and the source prompt
// changes by the difference of successive captions. In the space of embeddings the sum of these
// differences telescopes:
//   e_source,i = e(y_source) + lambda mean_v w_v [ e(B(I_i,v)) - e(B(I_0,v)) ],
//
// over a few views v. The paper's formula adds the sum to the direction, target minus source, which
// is the opposite sign: `paper_sign`.
//
// Useless captions do no harm: w_v is a quarter where a caption does not mention the object, and 0
// where it is empty or was cut off. The source moves at most as far as the target is away.
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

/// Returns the words that name the object: those in both sentences, without "a", "of" and the like;
/// the source's words where they share none. Lower case.
std::vector<std::string> object_words(const std::string& source_prompt,
                                      const std::string& target_prompt);

/// True if one of these words, or its plural, is in the caption.
bool mentions(const std::string& caption, const std::vector<std::string>& words);

class CaptionSource {
  public:
    CaptionSource(std::shared_ptr<const DiffusionModel> pipeline, const std::string& source_prompt,
                  const std::string& target_prompt, const CaptionSourceOptions& options);

    /// Returns the shift of the source prompt's embedding (one row), from the captions of the same
    /// views before the edit and now. No value when no view has usable captions.
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
