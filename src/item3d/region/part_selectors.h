// Selectors by the names of a model's parts in its file.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// Select by name: exactly, or case-insensitively if there is no exact match. Instances of one mesh
/// share their textures, so they are in a region together. Each throws InputError that lists the
/// available names.
std::unique_ptr<Selector> select_material(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_node(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_mesh(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_group(const SelectorText& text, const RegionScene& scene);
/// Weight: the attribute's first component, clamped to [0, 1] and interpolated over triangles.
std::unique_ptr<Selector> select_attribute(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
