// Parts of a glTF that depend on the appearance of an edited material. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

inline constexpr const char* transform_name = "KHR_texture_transform";

/// A texture that was replaced in an edited material.
struct ReplacedTexture {
    std::size_t old_texture;
    std::size_t new_texture;
    bool is_base_color = false;
};

/// True if `value`, under this key, is a texture info: an object with an index into the document's
/// textures.
bool is_texture_info(const std::string& key, const Json& value);

/// True if two textures of the document share an image, or have images of equal bytes.
bool shows_same_image(const SourceDocument& document, std::size_t a, std::size_t b);

/// Changes every texture info within `value` from set 0 to `set`.
void move_texture_coordinates(Json& value, std::size_t set);

/// Returns the replacement of `texture` if its image was replaced, else null.
const ReplacedTexture* find_replaced(const SourceDocument& document,
                                     const std::vector<ReplacedTexture>& replaced,
                                     std::size_t texture);

/// Updates VRM 0.x's duplicate list of each material's textures and colours (materialProperties).
/// Warns of toon textures that keep the old look. new_uvs: true if the material has a second UV
/// map; VRM 0.x supports only one.
void follow_vrm(const SourceDocument& document, std::size_t material,
                const std::vector<ReplacedTexture>& replaced, bool new_uvs, Json& json);

/// Warns of animations that change an edited material.
void warn_of_animations(const SourceDocument& document, std::size_t material);

/// Returns the materials that replace `material` at a distance (MSFT_lod).
std::vector<std::size_t> lod_materials(const SourceDocument& document, std::size_t material);

/// Keeps the old appearance of primitives that are not in `shown`, a set of (mesh, primitive), but
/// have one of `materials`: they get a copy of the original material, with a warning. The edited
/// material would need a new UV map, which such primitives do not get.
void keep_unseen_meshes(const SourceDocument& document, const std::set<std::pair<int, int>>& shown,
                        const std::set<int>& materials, Json& json);

/// Removes extensions from the lists of used and required extensions if `before` used them and
/// `after`, the edited version, does not.
void forget_unused_extensions(const Json& before, Json& after);

}  // namespace item3d
