#include "item3d/suite/look_by_clip.h"

#include "item3d/core/error.h"
#include "item3d/suite/cases.h"

namespace item3d {

std::string look_by_clip(const at::Tensor& images, const std::string& noun, const Clip& clip,
                         const PriorVocabulary& vocabulary, const std::vector<std::string>& kinds) {
    std::vector<std::string> words, sentences;
    for (const std::string& kind : kinds) {
        for (const KnownWord& known : vocabulary.words_of(kind)) {
            words.push_back(known.word);
            // reading() replaces nouns on which the prior, and thus its CLIP, was not trained.
            sentences.push_back(vocabulary.reading(prompt_of(known.caption, noun)));
        }
    }
    ITEM3D_CHECK(!words.empty(), "no image to measure");
    const at::Tensor scores =
        clip.embed_images(images).matmul(clip.embed_texts(sentences).t()).mean(0);
    return words[static_cast<std::size_t>(scores.argmax().item<std::int64_t>())];
}

}  // namespace item3d
