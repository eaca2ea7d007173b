// Selectors by what the file calls the parts of a model.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// All compare names exactly, and without regard to case where none is the same. Instances of one
/// mesh share their textures, so they are in a region together. Each throws InputError that lists
/// the names that there are.
std::unique_ptr<Selector> select_material(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_node(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_mesh(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_group(const SelectorText& text, const RegionScene& scene);
/// The attribute's first component, clamped to [0, 1] and interpolated over triangles.
std::unique_ptr<Selector> select_attribute(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
