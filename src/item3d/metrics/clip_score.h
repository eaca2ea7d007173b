// CLIP scores of an edit by its two sentences.
#pragma once

#include "item3d/networks/vision_language/clip.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// CLIP scores: cosines of embeddings, each in [-1, 1].
struct ClipScore {
    double global = 0;         ///< of the edited image and the target sentence
    double global_before = 0;  ///< of the unedited image and the target sentence
    /// Cosine between the change of the image embedding and the change of the text embedding
    /// (StyleGAN-NADA, Gal et al. 2022); 0 if either change is zero.
    double directional = 0;
};

struct ClipScores {
    ClipScore mean;
    std::vector<ClipScore> views;
};

/// Scores the same N views of a model before and after its edit, rendered in the same light: [N, 3,
/// H, W] sRGB in [0, 1].
ClipScores clip_scores(const Clip& clip, const at::Tensor& before, const at::Tensor& after,
                       const std::string& from, const std::string& to);

void to_json(nlohmann::json& json, const ClipScore& score);

}  // namespace item3d
