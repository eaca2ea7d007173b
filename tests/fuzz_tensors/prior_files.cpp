#include "item3d/networks/verify.h"
#include "item3d/networks/vocabulary.h"
#include "tests/fuzz/fuzz.h"

/// Verifies a folder with model_index.json and prior.json but without networks, and asks its
/// vocabulary about prompts.
ITEM3D_FUZZ_TARGET(prior_files, data, size) {
    using namespace item3d;
    const auto folder = fuzz::as_files("prior_files", {"prior.json", "model_index.json"},
                                       fuzz::as_text(data, size));
    fuzz::read_or_refuse([&] { verify_prior(folder); });
    return fuzz::read_or_refuse([&] {
        const PriorVocabulary vocabulary = PriorVocabulary::load(folder);
        for (const char* prompt : {"a golden mug", "a zigzag rabbit"}) {
            vocabulary.warning(prompt, true);
            vocabulary.reading(prompt);
        }
        vocabulary.words_of("colors");
    });
}
