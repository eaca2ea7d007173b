// What is true of a training picture, and plain sentences that claim some of it: what CLIP and the
// captioner learn from. (The diffusion prior's own captions are in captions.h.)
#pragma once

#include "item3d/core/random.h"
#include "item3d/prior/data/lights.h"
#include "item3d/prior/data/materials/materials.h"
#include "item3d/prior/data/shapes/shapes.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

struct PictureFacts {
    /// Ways to say the material, "{o}" for the noun; all are true, the first is the plainest:
    /// "red {o}" also for a glossy one.
    std::vector<std::string> phrases;
    /// Nouns of the object, the commonest first; "object" alone for a class that is held out.
    std::vector<std::string> nouns;
    /// " at sunset"; empty for a light without words.
    std::vector<std::string> lights;
};

/// A part of the object that has a material of its own.
struct PartMaterial {
    std::string noun;
    ProceduralMaterial material;
};

/// With a part, the plainest phrase is "wooden {o} with a red seat"; what is true of the rest alone
/// ("wooden {o}") is true too. The shape is called "object" where its class is held out.
PictureFacts facts_of(const ShapeClass& shape, const ProceduralMaterial& material,
                      const TrainingLight& light, const PartMaterial* part = nullptr);

/// A sentence's meaning.
struct PictureClaim {
    std::string phrase;  ///< of the material; empty: nothing is said about it
    std::string noun;    ///< "object" claims nothing
    std::string light;   ///< empty: nothing is said about it
    /// "a golden mug at sunset"; `frame` stands in front: "a photo of ".
    std::string text(const std::string& frame = "") const;
};

/// Whether everything that is claimed is so.
bool holds(const PictureClaim& claim, const PictureFacts& facts);

/// Material and object in their plainest words, nothing about the light.
PictureClaim plain_claim(const PictureFacts& facts);
/// The same without the part that has a material of its own.
PictureClaim whole_claim(const PictureFacts& facts);
/// One of the true sentences: mostly material and object, now and then less or with the light.
PictureClaim draw_claim(Random& random, const PictureFacts& facts);
/// Mostly "", else "a photo of " and its like.
const std::string& draw_frame(Random& random);

/// Which of the two that a plain caption names are right.
struct CaptionVerdict {
    bool object = false;
    bool material = false;
    bool material_name = false;
};
/// Reads "a golden mug", with or without a frame. The object is right where the caption's first
/// noun is one of its nouns; the material where all the rest is one of its phrases, word for word;
/// its name where only that is right: velvet or stripes of whatever colours, bronze of whatever
/// finish, and the colour of what is of one colour and nothing else.
CaptionVerdict judge_caption(const std::string& caption, const PictureFacts& facts);

void to_json(nlohmann::json& json, const PictureFacts& facts);
void from_json(const nlohmann::json& json, PictureFacts& facts);

}  // namespace item3d
