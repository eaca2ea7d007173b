// Accuracy of a prior for each word by the diffusion classifier (Li et al. 2023, "Your Diffusion
// Model is Secretly a Zero-Shot Classifier"), on renders of held-out shapes.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/prior/data/dataset.h"

#include <nlohmann/json.hpp>

#include <set>
#include <string>
#include <vector>

namespace item3d {

/// Measured word, and the material, light or shape by which an image shows it.
struct VocabularyEntry {
    std::string kind;  ///< a KnownWord::kind
    std::string word;
    std::vector<std::string> spellings;
    std::string caption;      ///< "a wooden {o}"
    MaterialWish material;    ///< a random plain colour if empty
    std::string light;        ///< TrainingLight::kind; "plain" if empty
    std::string shape_class;  ///< objects only
    /// MaterialWord::colored_caption. If the material could have any colours, the captions of the
    /// word and of its rivals name the actual colours, so that only the word is tested.
    std::string colored_caption;
};

/// Returns all measured words, by kind.
const std::vector<VocabularyEntry>& prior_vocabulary();

struct MeasureOptions {
    int images = 12;  ///< images per word
    int rivals = 30;  ///< maximum number of other words of the same kind, drawn anew for each image
    /// Words that the prior was trained on. Entries with other words are left out. If empty, no
    /// entry is left out.
    std::set<std::string> words;
    std::uint64_t seed = 7;
    int threads = 2;
};

/// Returns views of shapes outside the training data, in the size of the prior's images: six of
/// each held-out variant, and of each variant of the held-out classes. Throws InputError for a
/// prior whose images are not of 64 or 128 pixels.
std::vector<ShapeView> held_out_views(const DiffusionModel& pipeline, std::uint64_t seed,
                                      int threads);

/// Measures how often the right caption has the lowest denoising loss on an image of its word,
/// among the captions of rivals of its kind. A general word and a special one are not rivals: oak
/// is also wood. Returns {"vocabulary": {kind: [{word, spellings, accuracy, most_confused_with,
/// base_color?}]}, "kinds": {kind: {"words", "accuracy", "on_new_classes"?}}, "accuracy": mean over
/// all}. "on_new_classes" covers only images of held-out classes. The images show `views`. A U-Net
/// that is conditioned on shape gets the shape of the view, except for the kind of objects.
nlohmann::json measure_prior(const DiffusionModel& pipeline, const std::vector<ShapeView>& views,
                             const MeasureOptions& options = {});

}  // namespace item3d
