// What each pixel of a training picture belongs to, and prompts with what they name of it: what the
// segmenter learns from.
#pragma once

#include "item3d/core/random.h"
#include "item3d/prior/data/dataset.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

/// No shape has more parts, so that a set of them fits 32 bits.
inline constexpr std::size_t most_parts = 32;

struct PartFacts {
    std::string shape_class;
    /// Of the object, the commonest first; "object" alone for a class that is held out.
    std::vector<std::string> nouns;
    std::vector<std::string> parts;    ///< names, "" for the first: the rest of the object
    std::vector<std::uint8_t> seen;    ///< of each: 0 not at all, 1 hardly, 2 well enough to ask
    std::uint32_t own = 0;             ///< set of the parts with a material of their own
    std::vector<std::string> phrases;  ///< of the rest's material, as adjectives: "red", "wooden"
    std::vector<std::string> own_phrases;  ///< and of those parts
};
void to_json(nlohmann::json& json, const PartFacts& facts);
void from_json(const nlohmann::json& json, PartFacts& facts);

PartFacts part_facts_of(const Example& example);

/// [S, S] uint8: 0 behind the object, else 1 + the index of a part.
at::Tensor part_map_of(const Example& example);

/// A prompt and the parts that it names: bit i is part i; 0 where nothing is so.
struct PartPrompt {
    std::string text;
    std::uint32_t parts = 0;
};

/// Parts of that name.
std::uint32_t parts_named(const PartFacts& facts, const std::string& noun);
/// All of them.
std::uint32_t whole_object(const PartFacts& facts);
/// Names of the parts that are seen well enough, each once.
std::vector<std::string> named_parts(const PartFacts& facts);
/// Whether the object or one of its parts has that name, in either number: "handles" are there
/// where a handle is.
bool has_named(const PartFacts& facts, const std::string& noun);
/// Every name that a part of any class has.
const std::vector<std::string>& all_part_nouns();

/// A prompt about that picture: a part ("the handle"), a material ("the red part", "wooden"), the
/// object, or one of these that is not on it.
PartPrompt draw_part_prompt(Random& random, const PartFacts& facts);

}  // namespace item3d
