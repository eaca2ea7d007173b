// Accuracy of a segmenter on named parts of held-out shapes.
#pragma once

#include "item3d/networks/vision_language/segmenter.h"
#include "item3d/prior/data/part_images.h"

#include <nlohmann/json.hpp>

#include <cstdint>

namespace item3d {

/// Draws images of shapes outside the training data: two variants of each class, held-out classes
/// included, in random materials, lights and backgrounds. Throws Interrupted.
PartImages draw_held_out_parts(std::uint64_t seed, std::int64_t count, int threads);

/// Segments each image by the name of every visible part, the object, the material of a part that
/// differs from the rest, and one part that is absent. The IoU is the number of pixels that are
/// both above one half in the mask and in the named part, divided by the number of pixels that are
/// at least one of these. Every image has the same weight. Returns {"pictures": N,
///          "part_iou": mean over words, "part_iou_of_pictures": mean over all prompts,
///          "new_class_iou": part_iou_of_pictures on classes outside the training data,
///          "object_iou", "material_iou",
///          "absent_marked": fraction of the object that is marked for an absent part,
///          "words": {NAME: {"iou", "asked"}}, the worst first in "worst": [[NAME, IoU], ...],
///          "classes": {CLASS: {"iou", "asked"}}}.
nlohmann::json measure_parts(const Segmenter& segmenter, const PartImages& images);

/// Returns measure_parts() with {"names": {NAME: IoU}} in place of words, worst and classes.
nlohmann::json part_summary(const nlohmann::json& measured);

}  // namespace item3d
