// The interface of selectors, which choose a part of a model's surface.
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

/// The model from whose surface selectors choose a part. All members must outlive the selectors.
struct RegionScene {
    const Model& model;
    const Geometry& geometry;
    const TexturedMaterials& textured;
    const FieldSpace& space;
    const RegionReaders* readers = nullptr;  ///< for words and "auto"; null if there are none
    bool says_notes = true;
};

/// Weights in [0, 1] at points of a surface.
class Selector {
  public:
    virtual ~Selector() = default;
    /// Returns the weights of the P points of `surface`, [P] float32 on the CPU. The surface is one
    /// of the scene's geometry, on its device.
    virtual at::Tensor weight(const Surface& surface) const = 0;
};

/// Makes a selector from "KIND=VALUE" or "KIND", where KIND is one of selector_kinds(). Throws
/// InputError with `text` as its subject.
std::unique_ptr<Selector> make_selector(const std::string& text, const RegionScene& scene);

/// True if a selector does not depend on the model's textures. Selectors by colour, by words, and
/// "auto" depend on them.
bool is_independent_of_textures(const std::string& text);

struct SelectorKind {
    std::string form;  ///< syntax: "sphere=X,Y,Z,R"
    std::string help;
};
const std::vector<SelectorKind>& selector_kinds();

/// The text of a selector.
struct SelectorText {
    std::string whole;  ///< subject of errors
    std::string value;  ///< text after the first "="
    std::string form;   ///< SelectorKind::form
};

/// Returns the value's comma-separated numbers. Throws InputError unless there are `count`.
std::vector<float> numbers_of(const SelectorText& text, std::size_t count);

}  // namespace item3d
