// What else of a glTF refers to the look of an edited material. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

inline constexpr const char* transform_name = "KHR_texture_transform";

/// A texture of the document whose place in an edited material another took.
struct ReplacedTexture {
    std::size_t old_texture;
    std::size_t new_texture;
    bool is_base_color = false;
};

/// Whether an object of this key is a texture info: it has an index into the document's textures.
bool is_texture_info(const std::string& key, const Json& value);

/// Whether two textures of the document show one image, or images of the same bytes.
bool shows_same_picture(const SourceDocument& document, std::size_t a, std::size_t b);

/// Makes every texture info within `value` that looks at set 0 look at `set`.
void move_texture_coordinates(Json& value, std::size_t set);

/// The new texture for `texture`, if the picture that it shows was replaced.
const ReplacedTexture* find_replaced(const SourceDocument& document,
                                     const std::vector<ReplacedTexture>& replaced,
                                     std::size_t texture);

/// VRM 0.x lists each material's textures and colours a second time (materialProperties): they
/// follow the replaced ones. Warns of toon textures that still show the old look. new_uvs: the
/// material has another UV map now, and VRM 0.x knows one alone.
void follow_vrm(const SourceDocument& document, std::size_t material,
                const std::vector<ReplacedTexture>& replaced, bool new_uvs, Json& json);

/// Warns of what goes on changing an edited material: animations that point at it.
void warn_of_animations(const SourceDocument& document, std::size_t material);

/// Materials that are shown instead of this one far away (MSFT_lod).
std::vector<std::size_t> lod_materials(const SourceDocument& document, std::size_t material);

/// Primitives that are not among the `shown` ones (mesh, primitive) have no part in new UV maps:
/// where they have one of these materials, they get a copy of it as it was, with a warning.
void keep_unseen_meshes(const SourceDocument& document, const std::set<std::pair<int, int>>& shown,
                        const std::set<int>& materials, Json& json);

/// Takes those extensions off the lists of used and required ones that `before` had and `after`,
/// which it became, has nowhere any more.
void forget_unused_extensions(const Json& before, Json& after);

}  // namespace item3d
