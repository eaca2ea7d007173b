// How well a CLIP tells pictures of held-out shapes apart by their captions, and how often a
// captioner names what is on them.
#pragma once

#include "item3d/networks/vision_language/captioner.h"
#include "item3d/networks/vision_language/clip.h"
#include "item3d/prior/data/labeled_pictures.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <vector>

namespace item3d {

/// Pictures of shapes that are never trained on: two variants of each class, the held-out one among
/// them, in random materials, lights and backgrounds, by the proportions of the training.
LabeledPictures draw_held_out(std::uint64_t seed, std::int64_t count, int views_each, int lights,
                              int threads);

struct RetrievalAccuracy {
    int rounds = 0;
    int candidates = 0;             ///< captions, and as many pictures, of a round
    double picture_to_caption = 0;  ///< part of the pictures whose own caption is the nearest
    double caption_to_picture = 0;
};
void to_json(nlohmann::json& json, const RetrievalAccuracy& accuracy);

/// Plain captions ("a golden mug") against each other. A round's pictures are the next in order
/// whose caption is not true of another of its pictures, nor another's of it; as many rounds as the
/// pictures suffice for. Throws InputError when they don't suffice for one.
RetrievalAccuracy measure_retrieval(const Clip& clip, const LabeledPictures& pictures,
                                    int candidates = 100);

/// Parts of the pictures, or models, whose caption names the right ... (labels.h, judge_caption).
struct CaptionAccuracy {
    std::int64_t count = 0;  ///< of captions
    double object = 0;
    double material = 0;
    double object_or_material = 0;
    double both = 0;
    double material_name = 0;
    double object_and_name = 0;
};
void to_json(nlohmann::json& json, const CaptionAccuracy& accuracy);

CaptionAccuracy measure_captions(const Captioner& captioner, const LabeledPictures& pictures,
                                 int threads);

/// Models as `item3d caption` looks at one: views of the same thing, and what is true of it.
struct LabeledModels {
    std::vector<std::vector<at::Tensor>> views;  ///< [N][V] of [S, S, 3] uint8 sRGB
    std::vector<PictureFacts> facts;             ///< [N]
};

/// `count` shapes that are never trained on, in random materials by the proportions of the
/// training, each in `views` pictures from random sides, before an even grey in a studio's light.
LabeledModels draw_held_out_models(std::uint64_t seed, std::int64_t count, int views, int threads);

/// The same of the one caption of all views of a model.
CaptionAccuracy measure_model_captions(const Captioner& captioner, const LabeledModels& models,
                                       int threads);

}  // namespace item3d
