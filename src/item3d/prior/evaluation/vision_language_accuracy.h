// Accuracy of a CLIP in matching images of held-out shapes with captions, and of a captioner in
// describing these images.
#pragma once

#include "item3d/networks/vision_language/captioner.h"
#include "item3d/networks/vision_language/clip.h"
#include "item3d/prior/data/labeled_images.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <vector>

namespace item3d {

/// Draws images of shapes outside the training data: two variants of each class, held-out classes
/// included, in random materials, lights and backgrounds, in the training's proportions.
LabeledImages draw_held_out(std::uint64_t seed, std::int64_t count, int views_each, int lights,
                            int threads);

struct RetrievalAccuracy {
    int rounds = 0;
    int candidates = 0;           ///< number of captions, and of images, of a round
    double image_to_caption = 0;  ///< fraction of images whose nearest caption is their own
    double caption_to_image = 0;
};
void to_json(nlohmann::json& json, const RetrievalAccuracy& accuracy);

/// Measures retrieval with plain captions ("a golden mug"). A round takes the next images whose
/// captions are mutually exclusive. There are as many rounds as the images suffice for. Throws
/// InputError if the images do not suffice for one round.
RetrievalAccuracy measure_retrieval(const Clip& clip, const LabeledImages& images,
                                    int candidates = 100);

/// Fractions of the captions that name the right object, material, ... (labels.h, judge_caption).
struct CaptionAccuracy {
    std::int64_t count = 0;  ///< number of captions
    double object = 0;
    double material = 0;
    double object_or_material = 0;
    double both = 0;
    double material_name = 0;
    double object_and_name = 0;
};
void to_json(nlohmann::json& json, const CaptionAccuracy& accuracy);

CaptionAccuracy measure_captions(const Captioner& captioner, const LabeledImages& images,
                                 int threads);

/// Models as `item3d caption` shows them to a captioner. A model has several views, and facts.
struct LabeledModels {
    std::vector<std::vector<at::Tensor>> views;  ///< [N][V] of [S, S, 3] uint8 sRGB
    std::vector<ImageLabels> labels;             ///< [N]
};

/// Draws `count` shapes that are not in the training data, with random materials in the proportions
/// of the training. Each has `views` images from random sides, in studio light, on uniform grey.
LabeledModels draw_held_out_models(std::uint64_t seed, std::int64_t count, int views, int threads);

/// Measures the joint caption of all views of a model.
CaptionAccuracy measure_model_captions(const Captioner& captioner, const LabeledModels& models,
                                       int threads);

}  // namespace item3d
