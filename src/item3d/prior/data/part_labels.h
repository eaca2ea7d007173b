// Part labels of a training image, and prompts with the parts that they name. They are the training
// data of the segmenter.
#pragma once

#include "item3d/core/random.h"
#include "item3d/prior/data/dataset.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

/// Maximum number of parts of a shape, so that a set of them fits into 32 bits.
inline constexpr std::size_t max_parts = 32;

struct PartLabels {
    std::string shape_class;
    /// Nouns of the object, the most frequent first. A held-out class has only "object".
    std::vector<std::string> nouns;
    std::vector<std::string> parts;  ///< names; the first is "", the object's main part
    /// Visibility of each part: 0 is hidden, 1 is barely visible, 2 is visible enough for a prompt.
    std::vector<std::uint8_t> seen;
    std::uint32_t own = 0;  ///< set of the parts with their own material
    /// Phrases of the object's material, as adjectives: "red", "wooden".
    std::vector<std::string> phrases;
    std::vector<std::string> own_phrases;  ///< phrases of the material of the parts in `own`
};
void to_json(nlohmann::json& json, const PartLabels& labels);
void from_json(const nlohmann::json& json, PartLabels& labels);

PartLabels part_labels_of(const Example& example);

/// Returns a label for each pixel, [S, S] uint8: 0 for background, otherwise 1 + the index of a
/// part.
at::Tensor part_map_of(const Example& example);

/// Prompt and the set of parts that it names. Bit i of the set stands for part i. The set is 0 if
/// the prompt names no part of the image.
struct PartPrompt {
    std::string text;
    std::uint32_t parts = 0;
};

/// Returns the set of parts of that name.
std::uint32_t parts_named(const PartLabels& labels, const std::string& noun);
/// Returns the set of all parts.
std::uint32_t whole_object(const PartLabels& labels);
/// Returns the names of the parts that are visible enough for a prompt, each once.
std::vector<std::string> named_parts(const PartLabels& labels);
/// True if the object or one of its parts has that name, singular or plural.
bool has_named(const PartLabels& labels, const std::string& noun);
/// Returns all names of parts of any class.
const std::vector<std::string>& all_part_nouns();

/// Draws a prompt about the image: a part ("the handle"), a material ("the red part", "wooden"), or
/// the object. Some prompts name a part, material or object that the image does not show.
PartPrompt draw_part_prompt(Random& random, const PartLabels& labels);

}  // namespace item3d
