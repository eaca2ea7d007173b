// Facts of a training image, and plain sentences about these facts. They are the training data of
// CLIP and the captioner. (The diffusion prior's own captions are in captions.h.)
#pragma once

#include "item3d/core/random.h"
#include "item3d/prior/data/lights.h"
#include "item3d/prior/data/materials/materials.h"
#include "item3d/prior/data/shapes/shapes.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

struct ImageLabels {
    /// Phrases of the material, in which "{o}" stands for the noun. All phrases are true, and the
    /// first is the plainest. It is "red {o}" for a glossy red object too.
    std::vector<std::string> phrases;
    /// Nouns of the object, the most frequent first. A held-out class has only "object".
    std::vector<std::string> nouns;
    /// Phrases such as " at sunset"; empty for a light without words.
    std::vector<std::string> lights;
};

/// Part of the object that has its own material.
struct PartMaterial {
    std::string noun;
    ProceduralMaterial material;
};

/// Returns the facts of an image. If a part has its own material, the plainest phrase names it, as
/// in "wooden {o} with a red seat"; "wooden {o}" is true too. A held-out class is called "object".
ImageLabels labels_of(const ShapeClass& shape, const ProceduralMaterial& material,
                      const TrainingLight& light, const PartMaterial* part = nullptr);

/// Claims that a sentence makes about an image.
struct ClaimedLabels {
    std::string phrase;  ///< phrase of the material; empty if the sentence names no material
    std::string noun;    ///< "object" if the sentence names no class
    std::string light;   ///< empty if the sentence names no light
    /// Returns the sentence, such as "a golden mug at sunset". frame: text in front of it, such as
    /// "a photo of ".
    std::string text(const std::string& frame = "") const;
};

/// True if all claims of the sentence hold.
bool holds(const ClaimedLabels& claim, const ImageLabels& labels);

/// Returns the claims about material and object in their plainest words, without the light.
ClaimedLabels plain_claim(const ImageLabels& labels);
/// Returns plain_claim() without the part that has its own material.
ClaimedLabels whole_claim(const ImageLabels& labels);
/// Draws a true sentence: usually about material and object, sometimes about one of them alone,
/// sometimes about the light too.
ClaimedLabels draw_claim(Random& random, const ImageLabels& labels);
/// Draws a frame: usually "", otherwise "a photo of " or similar.
const std::string& draw_frame(Random& random);

/// Verdict on the parts of a plain caption. A part is true if it is correct.
struct CaptionVerdict {
    bool object = false;
    bool material = false;
    bool material_name = false;
};
/// Judges a caption such as "a golden mug", with or without a frame. The object is right if the
/// caption's first noun is one of the object's nouns. The material is right if the rest of the
/// caption is, word for word, one of the material's phrases. The material's name is right if the
/// caption names the same material or pattern, such as velvet, stripes or bronze, in any colours or
/// finish. For a material that is only a colour, the colour counts as its name.
CaptionVerdict judge_caption(const std::string& caption, const ImageLabels& labels);

void to_json(nlohmann::json& json, const ImageLabels& labels);
void from_json(const nlohmann::json& json, ImageLabels& labels);

}  // namespace item3d
