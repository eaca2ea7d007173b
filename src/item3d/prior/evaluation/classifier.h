// What a prior has learnt, word by word: the diffusion classifier (Li et al. 2023, "Your Diffusion
// Model is Secretly a Zero-Shot Classifier") on renders of shapes that were held out.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/prior/data/dataset.h"

#include <nlohmann/json.hpp>

#include <set>
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
    /// MaterialWord::colored_caption. Captions say the colours of a picture that could have any,
    /// for the word is what is asked about; those of its rivals too.
    std::string colored_caption;
};

/// Every word that is measured, kind by kind.
const std::vector<VocabularyEntry>& prior_vocabulary();

struct MeasureOptions {
    int pictures = 12;  ///< a word
    int rivals = 30;    ///< at most so many other words of its kind, drawn anew for each picture
    /// What the prior was trained on; entries with other words are left out. Empty: everything.
    std::set<std::string> words;
    std::uint64_t seed = 7;
    int threads = 2;
};

/// Views of shapes that were never trained on, of the size of the prior's pictures: six of each
/// held-out variant, and of each variant of the held-out classes. Throws InputError for a prior
/// whose pictures are not of 64 or 128 pixels.
std::vector<ShapeView> held_out_views(const DiffusionModel& pipeline, std::uint64_t seed,
                                      int threads);

/// Which caption of a kind gives the lowest denoising loss on a picture of each of its words, the
/// right one or that of a rival? A word for many things has none of them as a rival: oak is wood.
/// Returns {"vocabulary": {kind: [{word, spellings, accuracy, most_confused_with, base_color?}]},
/// "kinds": {kind: {"words", "accuracy", "on_new_classes"?}}, "accuracy": mean over all}.
/// "on_new_classes" is of those pictures alone whose whole class was never trained on. The pictures
/// are of `views`, with their depth as the condition for all kinds but objects.
nlohmann::json measure_prior(const DiffusionModel& pipeline, const std::vector<ShapeView>& views,
                             const MeasureOptions& options = {});

}  // namespace item3d
