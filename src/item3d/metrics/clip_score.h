// How well an edit did what its two sentences say, in CLIP's eyes.
#pragma once

#include "item3d/networks/vision_language/clip.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// Cosines, each in [-1, 1].
struct ClipScore {
    double global = 0;         ///< the edited picture and the target sentence
    double global_before = 0;  ///< the unedited picture and the target sentence
    /// What changed in the picture and what changed in the sentence (StyleGAN-NADA, Gal et al.
    /// 2022); 0 where nothing did.
    double directional = 0;
};

struct ClipScores {
    ClipScore mean;
    std::vector<ClipScore> views;
};

/// before, after: [N, 3, H, W] sRGB in [0, 1], the same views in the same light.
ClipScores clip_scores(const Clip& clip, const at::Tensor& before, const at::Tensor& after,
                       const std::string& from, const std::string& to);

void to_json(nlohmann::json& json, const ClipScore& score);

}  // namespace item3d
