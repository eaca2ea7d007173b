// Facts of a training image, and plain sentences about them: training data of CLIP and the
// captioner. (The diffusion prior's own captions are in captions.h.)
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
    /// Phrases of the material, "{o}" for the noun. All are true, the first is the plainest: "red
    /// {o}" also for a glossy one.
    std::vector<std::string> phrases;
    /// Nouns of the object, the most frequent first; "object" alone for a held-out class.
    std::vector<std::string> nouns;
    /// Phrases such as " at sunset"; empty for a light without words.
    std::vector<std::string> lights;
};

/// Part of the object with its own material.
struct PartMaterial {
    std::string noun;
    ProceduralMaterial material;
};

/// Returns the facts of an image. With a part, the plainest phrase is "wooden {o} with a red seat";
/// "wooden {o}" is true too. A held-out class is called "object".
ImageLabels labels_of(const ShapeClass& shape, const ProceduralMaterial& material,
                      const TrainingLight& light, const PartMaterial* part = nullptr);

/// Meaning of a sentence.
struct ClaimedLabels {
    std::string phrase;  ///< phrase of the material; empty: no claim
    std::string noun;    ///< "object": no claim
    std::string light;   ///< empty: no claim
    /// Returns "a golden mug at sunset", with `frame` in front: "a photo of ".
    std::string text(const std::string& frame = "") const;
};

/// True if all claims of the sentence hold.
bool holds(const ClaimedLabels& claim, const ImageLabels& labels);

/// Returns material and object in their plainest words, without the light.
ClaimedLabels plain_claim(const ImageLabels& labels);
/// Returns plain_claim() without the part that has its own material.
ClaimedLabels whole_claim(const ImageLabels& labels);
/// Draws a true sentence: usually about material and object, sometimes about one of them alone,
/// sometimes about the light too.
ClaimedLabels draw_claim(Random& random, const ImageLabels& labels);
/// Draws a frame: usually "", else "a photo of " or similar.
const std::string& draw_frame(Random& random);

/// Correct parts of a plain caption.
struct CaptionVerdict {
    bool object = false;
    bool material = false;
    bool material_name = false;
};
/// Judges "a golden mug", with or without a frame. The object is right if the caption's first noun
/// is one of the object's nouns. The material is right if the rest of the caption is, word for
/// word, one of the material's phrases. The material's name is right if the caption names the same
/// material or pattern, in any colours or finish: velvet, stripes, bronze. For a material that is
/// only a colour, the colour counts as its name.
CaptionVerdict judge_caption(const std::string& caption, const ImageLabels& labels);

void to_json(nlohmann::json& json, const ImageLabels& labels);
void from_json(const nlohmann::json& json, ImageLabels& labels);

}  // namespace item3d
