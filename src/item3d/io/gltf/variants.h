// KHR_materials_variants: several appearances in one file. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Returns the names of the variants in the file's order; empty if the file has none.
std::vector<std::string> variant_names(const SourceDocument& document);

/// Returns the index of the named variant. Throws InputError that lists the variants.
std::size_t find_variant(const SourceDocument& document, const std::string& name);

/// Returns a primitive's material in a variant; no value where it keeps its default.
std::optional<std::size_t> material_in_variant(const SourceDocument& document,
                                               const GltfObject& primitive, std::size_t variant);

}  // namespace item3d
