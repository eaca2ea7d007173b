// Training examples. An example is an image of a random view, with a random material in a random
// light, and a caption.
#pragma once

#include "item3d/prior/data/labels.h"
#include "item3d/prior/data/lights.h"
#include "item3d/prior/data/materials/materials.h"
#include "item3d/prior/data/views.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

/// Fraction of images in which one part has its own material, among the images of shapes with
/// parts.
inline constexpr double two_part_share = .4;

/// Image with its caption and the facts that it shows.
struct Example {
    at::Tensor image;    ///< [S, S, 3] float32, sRGB in [0, 1]
    at::Tensor cells;    ///< see ShapeView::cells
    at::Tensor covered;  ///< [S, S] float32, fraction of the pixel that the object covers
    std::string caption;
    ImageLabels labels;
    std::string material;             ///< ProceduralMaterial::kind
    std::string light;                ///< TrainingLight::kind
    const ShapeView* view = nullptr;  ///< view that the image was drawn from
    bool mirrored = false;
    /// Index into view->parts of the part with its own material; 0 if no part has one.
    std::size_t own_part = 0;
    /// Phrases of the object's material, as in ProceduralMaterial.
    std::vector<std::string> phrases;
    std::vector<std::string> part_phrases;  ///< phrases of that part's material
};

/// Requirements of an example; members that are not set are drawn at random.
struct ExampleWish {
    MaterialWish material;
    const TrainingLight* light = nullptr;
    bool plain_background = false;  ///< uniform light grey
    /// Name of the part that gets its own material, if the shape has such a part. With "none", no
    /// part gets its own material.
    std::string part;
    MaterialWish part_material;
};

/// Returns indices into view.parts of the parts that are visible enough to be mentioned.
std::vector<std::size_t> visible_parts(const ShapeView& view);

/// Draws an example of a view. Material and light are random where `wish` does not give them.
Example draw_example(Random& random, const ShapeView& view,
                     const std::vector<TrainingLight>& lights, const ExampleWish& wish = {});

/// Two images of one view in the same light, before and after an instruction.
struct InstructionPair {
    at::Tensor before, after;  ///< [S, S, 3] float32, sRGB in [0, 1]
    at::Tensor cells;          ///< see ShapeView::cells
    std::string instruction;   ///< "make it golden", "give it a red handle"
};

/// Draws a pair of images of a view. In the second image the whole object, or one of its parts, has
/// another material.
InstructionPair draw_instruction_pair(Random& random, const ShapeView& view,
                                      const std::vector<TrainingLight>& lights,
                                      const ExampleWish& wish = {});

/// Source of examples from views and lights. Thread-safe.
class ExampleSource {
  public:
    ExampleSource(std::vector<ShapeView> views, std::vector<TrainingLight> lights,
                  std::uint64_t seed, float pattern_weight = 1);

    /// Draws the example of an index. The example depends on the seed and the index alone.
    Example draw(std::int64_t index) const;
    InstructionPair draw_pair(std::int64_t index) const;

    const std::vector<ShapeView>& views() const { return views_; }

  private:
    const ShapeView& draw_view(Random& random) const;

    std::vector<ShapeView> views_;
    std::vector<TrainingLight> lights_;
    std::uint64_t seed_;
    ExampleWish wish_;
};

}  // namespace item3d
