// CLIP scores of an edit by its two sentences.
#pragma once

#include "item3d/networks/vision_language/clip.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// CLIP scores: cosines, each in [-1, 1].
struct ClipScore {
    double global = 0;         ///< edited image and target sentence
    double global_before = 0;  ///< unedited image and target sentence
    /// Cosine between the changes of the image embedding and of the text embedding (StyleGAN-NADA,
    /// Gal et al. 2022); 0 if either change is zero.
    double directional = 0;
};

struct ClipScores {
    ClipScore mean;
    std::vector<ClipScore> views;
};

/// Scores views before and after: [N, 3, H, W] sRGB in [0, 1], the same views in the same light.
ClipScores clip_scores(const Clip& clip, const at::Tensor& before, const at::Tensor& after,
                       const std::string& from, const std::string& to);

void to_json(nlohmann::json& json, const ClipScore& score);

}  // namespace item3d
