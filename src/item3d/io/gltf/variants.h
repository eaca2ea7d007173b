// KHR_materials_variants: several looks in one file. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Names in the file's order; empty where it has no variants.
std::vector<std::string> variant_names(const SourceDocument& document);

/// The number of the variant of this name. Throws InputError that lists those that there are.
std::size_t find_variant(const SourceDocument& document, const std::string& name);

/// The material that a primitive has in a variant; no value where it keeps that of its own.
std::optional<std::size_t> material_in_variant(const SourceDocument& document,
                                               const GltfObject& primitive, std::size_t variant);

}  // namespace item3d
