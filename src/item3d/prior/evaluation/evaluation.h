// Evaluation of a trained prior in numbers and images, for the choice between candidates.
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
    int word_images = 12;       ///< images per word; 0 keeps the measurements in prior.json
    int images = 256;           ///< images for the autoencoder
    int labeled_images = 2000;  ///< images for CLIP and captioner
    int part_images = 800;      ///< images for the segmenter
    int labeled_models = 1000;  ///< models for the captioner, four views each
    std::uint64_t seed = 7;
    int threads = 2;
    /// Runs the edits of the prior's evaluation, after prior.json has the measured words. The
    /// result becomes "edits" (suite_totals() of suite/edit_suite.h). If empty, there are no edits.
    /// It is a function, because this library must not depend on the library of edits.
    std::function<nlohmann::json()> edits;
};

/// Evaluates the prior in `folder`: words (classifier.h), samples, autoencoder, and CLIP, captioner
/// and segmenter if the prior has them. Stores the measured words in the prior's prior.json and
/// writes evaluate.json, evaluate.html and the samples' sheets into `output`. Then runs the edits
/// and writes evaluate.json and evaluate.html again. Returns evaluate.json. Throws InputError for a
/// folder that is no prior or cannot be written to, and Interrupted, which leaves nothing written
/// if it comes before the edits.
nlohmann::json evaluate_prior(const std::filesystem::path& folder,
                              const std::filesystem::path& output,
                              const EvaluationOptions& options);

/// Measures the segmenter alone. The result of measure_parts() on held-out images is stored in the
/// prior's prior.json. Throws InputError for a folder without a segmenter, and Interrupted.
nlohmann::json evaluate_segmenter(const std::filesystem::path& folder,
                                  const EvaluationOptions& options);

/// Returns the HTML page of an evaluation. sheets: encoded images with their captions.
std::string evaluation_page(const nlohmann::json& evaluation,
                            const std::vector<std::pair<std::string, Bytes>>& sheets);

}  // namespace item3d
