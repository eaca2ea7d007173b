#include "item3d/io/gltf/variants.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/uv_layouts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace item3d {
namespace {

constexpr const char* variants_extension = "KHR_materials_variants";

}  // namespace

std::vector<std::string> variant_names(const SourceDocument& document) {
    std::vector<std::string> names;
    const auto extension = find_extension(root_of(document), variants_extension);
    if (!extension) return names;
    for (std::size_t i = 0; i < extension->list_size("variants"); ++i)
        names.push_back(extension->item("variants", i).text("name", fmt::format("variant_{}", i)));
    return names;
}

std::size_t find_variant(const SourceDocument& document, const std::string& name) {
    const std::vector<std::string> names = variant_names(document);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    throw InputError(document.path.string(), fmt::format("has no variant '{}'", name),
                     names.empty() ? "it has no variants, leave --variant out"
                                   : fmt::format("its variants are {}", fmt::join(names, ", ")));
}

std::optional<std::size_t> material_in_variant(const SourceDocument& document,
                                               const GltfObject& primitive, std::size_t variant) {
    const auto extension = find_extension(primitive, variants_extension);
    if (!extension) return std::nullopt;
    const std::size_t materials = root_of(document).list_size("materials");
    const std::size_t variants = variant_names(document).size();
    for (std::size_t i = 0; i < extension->list_size("mappings"); ++i) {
        const GltfObject mapping = extension->item("mappings", i);
        for (std::size_t k = 0; k < mapping.list_size("variants"); ++k) {
            if (mapping.index_item("variants", k, variants) == variant)
                return mapping.index("material", materials);
        }
    }
    return std::nullopt;
}

}  // namespace item3d
