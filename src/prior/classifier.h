// What a prior has learnt, word by word: the diffusion classifier (Li et al. 2023, "Your Diffusion
// Model is Secretly a Zero-Shot Classifier") on renders of shapes that were held out.
#pragma once

#include "item3d/models/pipeline.h"
#include "item3d/prior/dataset.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// One word and how to show it.
struct VocabularyEntry {
    std::string kind;  ///< as KnownWord::kind
    std::string word;
    std::vector<std::string> spellings;
    std::string caption;      ///< "a wooden {o}"
    MaterialWish material;    ///< empty: a plain colour at random
    std::string light;        ///< TrainingLight::kind; empty: "plain"
    std::string shape_class;  ///< objects only
};

/// Every word that is measured, kind by kind.
const std::vector<VocabularyEntry>& prior_vocabulary();

struct MeasureOptions {
    int pictures = 12;  ///< a word
    std::uint64_t seed = 7;
    int threads = 2;
};

/// Which caption of a kind gives the lowest denoising loss on a picture of each of its words?
/// Returns {"vocabulary": {kind: [{word, spellings, accuracy, most_confused_with, base_color?}]},
/// "accuracy": mean over all}. The pictures are of held-out shapes, with their depth as the
/// condition for all kinds but objects.
nlohmann::json measure_prior(const Pipeline& pipeline, const MeasureOptions& options = {});

}  // namespace item3d
