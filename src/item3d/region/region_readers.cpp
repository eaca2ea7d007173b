#include "item3d/region/region_readers.h"

#include "item3d/region/attention_reading.h"

namespace item3d {

namespace fs = std::filesystem;

bool needs_prior(const RegionRequest& request, bool has_segmenter) {
    return request.needs_sentences() || (request.needs_segmenter() && !has_segmenter);
}

std::vector<std::string> prompts_of_words(const RegionRequest& request) {
    const std::string kind = "words=";
    std::vector<std::string> prompts;
    for (const auto* selectors : {&request.include, &request.exclude})
        for (const std::string& text : *selectors)
            if (text.starts_with(kind))
                prompts.push_back(attention_prompt(text.substr(kind.size())));
    return prompts;
}

RegionReaders load_readers(const RegionRequest& request, const fs::path& folder,
                           const fs::path& prior, at::Device device) {
    RegionReaders readers;
    if (!request.needs_segmenter()) return readers;
    if (folder.empty()) {
        readers.vocabulary = PriorVocabulary::load(prior);
        return readers;
    }
    readers.segmenter =
        std::make_unique<Segmenter>(Segmenter::load_to_run(folder, device, at::kFloat));
    // A prior's own segmenter was trained on the prior's vocabulary.
    readers.vocabulary = PriorVocabulary::load(fs::weakly_canonical(folder).parent_path());
    return readers;
}

}  // namespace item3d
