// The sets of edited materials that are baked into the same images.
#pragma once

#include "item3d/field/surface_points.h"
#include "item3d/scene/model.h"

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

/// Edited materials that show the same textures with the same factors. They are baked into one
/// image for each slot.
struct TextureSet {
    std::vector<int> materials;           ///< in rising order
    std::vector<int> primitives;          ///< baked primitives; of several instances only the first
    std::vector<std::int32_t> triangles;  ///< indices in Atlas::triangles of the baked triangles
    /// If the set keeps its own UVs although several surface points share a texel: the reason, in
    /// words, why they share it. Otherwise empty.
    std::string shared;
    /// Reason, in words, why the set gets new UVs; otherwise empty.
    std::string remade;

    bool is_own() const { return remade.empty(); }
    bool has(int material) const;
};

/// Returns the sets of the visible `materials`, without triangles and reasons.
std::vector<TextureSet> texture_sets(const Model& model, const FieldSpace& space,
                                     const std::vector<int>& materials);

/// Returns "material 'hull'" or "materials 'hull', 'wings'".
std::string names_of(const Model& model, const TextureSet& set);

/// Returns the indices in Model::textures of a material's textures, the base colour's first.
std::vector<int> textures_of(const Material& material);

bool have_uvs(const Model& model, const std::vector<int>& primitives);

}  // namespace item3d
