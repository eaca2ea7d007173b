// What picks a part of a model's surface.
#pragma once

#include "item3d/field/surface_points.h"
#include "item3d/render/geometry.h"
#include "item3d/render/interpolate.h"
#include "item3d/render/textured_materials.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct RegionReaders;  // region_readers.h

/// The model that is selected on. All must outlive the selectors.
struct RegionScene {
    const Model& model;
    const Geometry& geometry;
    const TexturedMaterials& textured;
    const FieldSpace& space;
    const RegionReaders* readers = nullptr;  ///< for words and auto; null: there are none
    bool says_notes = true;
};

/// Weights in [0, 1] of places of a surface.
class Selector {
  public:
    virtual ~Selector() = default;
    /// [P] float32 on the CPU; surface: of the scene's geometry, on its device.
    virtual at::Tensor weight(const Surface& surface) const = 0;
};

/// KIND=VALUE or KIND, one of selector_kinds(). Throws InputError whose subject is `text`.
std::unique_ptr<Selector> make_selector(const std::string& text, const RegionScene& scene);

/// Whether a selector takes the same places whatever textures the model has: not by colour, nor by
/// words.
bool is_independent_of_textures(const std::string& text);

struct SelectorKind {
    std::string form;  ///< as it is written: "sphere=X,Y,Z,R"
    std::string help;
};
const std::vector<SelectorKind>& selector_kinds();

/// A selector as it was written.
struct SelectorText {
    std::string whole;  ///< the subject of errors
    std::string value;  ///< behind the first "="
    std::string form;   ///< SelectorKind::form
};

/// The value's numbers, with commas between. Throws InputError where there are not `count`.
std::vector<float> numbers_of(const SelectorText& text, std::size_t count);

}  // namespace item3d
