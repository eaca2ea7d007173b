// Selectors by the names of a model's parts in its file.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// These functions select parts by name, ignoring case if there is no exact match. Instances of one
/// mesh share their textures, so a region contains all of them or none. Each throws InputError that
/// lists the available names.
std::unique_ptr<Selector> select_material(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_node(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_mesh(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_group(const SelectorText& text, const RegionScene& scene);
/// Selects by a vertex attribute. The weight is the attribute's first component, clamped to [0, 1]
/// and interpolated over triangles.
std::unique_ptr<Selector> select_attribute(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
