// All that can be said of a trained prior in numbers and pictures, to choose between candidates.
#pragma once

#include "item3d/core/files.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/vision_language/clip_model.h"
#include "item3d/prior/data/views.h"
#include "item3d/scene/image.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

struct EvaluationOptions {
    int word_pictures = 12;       ///< that each word is asked about; 0: what prior.json says stays
    int pictures = 256;           ///< that the autoencoder is measured on
    int labeled_pictures = 2000;  ///< that CLIP and captioner are measured on
    int labeled_models = 1000;    ///< that the captioner is, each from four sides
    std::uint64_t seed = 7;
    int threads = 2;
    /// Runs the edits that the prior is judged by, when its prior.json has the words that were
    /// measured; what it returns becomes "edits" (suite_totals() of suite/edit_suite.h). Empty: no
    /// edits. The library of edits is above this one.
    std::function<nlohmann::json()> edits;
};

/// A grid of generated pictures, objects across and materials down.
struct SampleGrid {
    std::vector<std::string> objects;    ///< nouns
    std::vector<std::string> materials;  ///< captions, "{o}" for the noun
    std::vector<std::string> prompts;    ///< row by row
    std::vector<Image> pictures;         ///< row by row, sRGB
};

/// At most `side` by `side` of what the prior was trained on, drawn with its own defaults: from the
/// prompts alone, or in the shape of held-out objects.
SampleGrid draw_samples(const std::filesystem::path& prior, const Pipeline& pipeline,
                        const std::set<std::string>& words, int side, bool with_shape,
                        std::uint64_t seed);

/// How well a CLIP, the prior's own, knows the samples again, among all prompts of the grid:
/// {"pictures", "right", "object_right", "material_right", "similarity"}; parts, and the mean
/// cosine of picture and prompt.
nlohmann::json score_samples(const Clip& clip, const SampleGrid& grid);

/// Held-out pictures before and behind the autoencoder.
struct ReconstructionMeasure {
    double psnr = 0;                               ///< dB
    double object_psnr = 0;                        ///< of object pixels alone
    std::vector<Image> pictures, reconstructions;  ///< of the first few
};
ReconstructionMeasure measure_autoencoder(const Pipeline& pipeline,
                                          const std::vector<ShapeView>& views, int pictures,
                                          std::uint64_t seed);

/// Evaluates the prior in `folder`: words (classifier.h), samples, autoencoder, and CLIP and
/// captioner where it has them. Puts the words into its prior.json and writes evaluate.json,
/// evaluate.html and the samples' sheets into `output`; runs the edits, and writes both again.
/// Returns evaluate.json. Throws InputError for a folder that is no prior or cannot be written to;
/// Interrupted, before the edits with nothing written.
nlohmann::json evaluate_prior(const std::filesystem::path& folder,
                              const std::filesystem::path& output,
                              const EvaluationOptions& options);

/// The page of it. sheets: encoded pictures with their captions.
std::string evaluation_page(const nlohmann::json& evaluation,
                            const std::vector<std::pair<std::string, Bytes>>& sheets);

}  // namespace item3d
