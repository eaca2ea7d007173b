// All that can be said of a trained prior in numbers and pictures, to choose between candidates.
#pragma once

#include "item3d/core/files.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

struct EvaluationOptions {
    int word_pictures = 12;       ///< that each word is asked about; 0: what prior.json says stays
    int pictures = 256;           ///< that the autoencoder is measured on
    int labeled_pictures = 2000;  ///< that CLIP and captioner are measured on
    int part_pictures = 800;      ///< that the segmenter is measured on
    int labeled_models = 1000;    ///< that the captioner is, each from four sides
    std::uint64_t seed = 7;
    int threads = 2;
    /// Runs the edits that the prior is judged by, when its prior.json has the words that were
    /// measured; what it returns becomes "edits" (suite_totals() of suite/edit_suite.h). Empty: no
    /// edits. The library of edits is above this one.
    std::function<nlohmann::json()> edits;
};

/// Evaluates the prior in `folder`: words (classifier.h), samples, autoencoder, CLIP, captioner
/// and segmenter where it has them. Puts the words into its prior.json and writes evaluate.json,
/// evaluate.html and the samples' sheets into `output`; runs the edits, and writes both again.
/// Returns evaluate.json. Throws InputError for a folder that is no prior or cannot be written to;
/// Interrupted, before the edits with nothing written.
nlohmann::json evaluate_prior(const std::filesystem::path& folder,
                              const std::filesystem::path& output,
                              const EvaluationOptions& options);

/// Its segmenter alone: measure_parts() on held-out pictures, which is put into its prior.json.
/// Throws InputError for a folder without a segmenter, and Interrupted.
nlohmann::json evaluate_segmenter(const std::filesystem::path& folder,
                                  const EvaluationOptions& options);

/// The page of it. sheets: encoded pictures with their captions.
std::string evaluation_page(const nlohmann::json& evaluation,
                            const std::vector<std::pair<std::string, Bytes>>& sheets);

}  // namespace item3d
