// How well a segmenter finds the parts of held-out shapes by their names.
#pragma once

#include "item3d/networks/vision_language/segmenter.h"
#include "item3d/prior/data/part_pictures.h"

#include <nlohmann/json.hpp>

#include <cstdint>

namespace item3d {

/// Pictures of shapes that are never trained on: two variants of each class, the held-out classes
/// among them, in random materials, lights and backgrounds. Throws Interrupted.
PartPictures draw_held_out_parts(std::uint64_t seed, std::int64_t count, int threads);

/// Asks for every part that is seen by its name, for the object, for the material of a part that
/// has another than the rest, and for one part that is not there. IoU: pixels that are above one
/// half and named, of those that are either; each picture counts the same.
/// Returns {"pictures": N,
///          "part_iou": mean over words, "part_iou_of_pictures": mean over all questions,
///          "new_class_iou": the latter on classes that were never trained on,
///          "object_iou", "material_iou",
///          "absent_marked": part of the object that is marked for a part that is not there,
///          "words": {NAME: {"iou", "asked"}}, the worst first in "worst": [[NAME, IoU], ...],
///          "classes": {CLASS: {"iou", "asked"}}}.
nlohmann::json measure_parts(const Segmenter& segmenter, const PartPictures& pictures);

/// The same without words and classes.
nlohmann::json part_summary(const nlohmann::json& measured);

}  // namespace item3d
