// Training pairs: a random material and light on a random view, with its caption.
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

/// Of the pictures of shapes that have parts, so many show one in a material of its own.
inline constexpr double two_part_share = .4;

/// A picture with its caption and what is on it.
struct Example {
    at::Tensor image;    ///< [S, S, 3] float32, sRGB in [0, 1]
    at::Tensor cells;    ///< as ShapeView::cells
    at::Tensor covered;  ///< [S, S] float32, part of the pixel that is object
    std::string caption;
    PictureFacts facts;
    std::string material;             ///< ProceduralMaterial::kind
    std::string light;                ///< TrainingLight::kind
    const ShapeView* view = nullptr;  ///< what it was drawn from
    bool mirrored = false;
    /// Index into view->parts of the part with a material of its own; 0: there is none.
    std::size_t own_part = 0;
    std::vector<std::string> phrases;       ///< of the material of the rest, ProceduralMaterial's
    std::vector<std::string> part_phrases;  ///< and of that part
};

/// What an example should show; what is not said is drawn at random.
struct ExampleWish {
    MaterialWish material;
    const TrainingLight* light = nullptr;
    bool plain_background = false;  ///< an even light grey
    /// Name of a part that gets a material of its own, where the shape has it; "none" for none.
    std::string part;
    MaterialWish part_material;
};

/// Indices into view.parts of those that can be seen well enough to be talked about.
std::vector<std::size_t> visible_parts(const ShapeView& view);

/// Draws an example of that view: its material and, unless the wish names one, its light.
Example draw_example(Random& random, const ShapeView& view,
                     const std::vector<TrainingLight>& lights, const ExampleWish& wish = {});

/// One view twice, in the same light: as it was, and as an instruction changes it.
struct InstructionPair {
    at::Tensor before, after;  ///< [S, S, 3] float32, sRGB in [0, 1]
    at::Tensor cells;          ///< as ShapeView::cells
    std::string instruction;   ///< "make it golden", "give it a red handle"
};

/// Draws a pair of that view: another material of all of it, or of one of its parts.
InstructionPair draw_instruction_pair(Random& random, const ShapeView& view,
                                      const std::vector<TrainingLight>& lights,
                                      const ExampleWish& wish = {});

/// Draws examples from views and lights; safe to use from several threads.
class ExampleSource {
  public:
    ExampleSource(std::vector<ShapeView> views, std::vector<TrainingLight> lights,
                  std::uint64_t seed, float pattern_weight = 1);

    /// The example of that index depends on the seed and the index alone.
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
