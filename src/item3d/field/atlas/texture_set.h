// Which edited materials are baked into the same images.
#pragma once

#include "item3d/field/surface_points.h"
#include "item3d/scene/model.h"

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

/// Edited materials that show the same textures with the same factors: baked into one image a slot.
struct TextureSet {
    std::vector<int> materials;           ///< in rising order
    std::vector<int> primitives;          ///< that are baked: of instances the first alone
    std::vector<std::int32_t> triangles;  ///< that are baked, indices into Atlas::triangles
    /// Why its own UVs can't give each place of the surface texels of its own, in words, and are
    /// kept all the same.
    std::string shared;
    /// Why its UVs are new, in words.
    std::string remade;

    bool is_own() const { return remade.empty(); }
    bool has(int material) const;
};

/// The sets of those `materials` that are seen, without triangles and reasons yet.
std::vector<TextureSet> texture_sets(const Model& model, const FieldSpace& space,
                                     const std::vector<int>& materials);

/// "material 'hull'", "materials 'hull', 'wings'".
std::string names_of(const Model& model, const TextureSet& set);

/// Indices into Model::textures, the base colour's first.
std::vector<int> textures_of(const Material& material);

bool have_uvs(const Model& model, const std::vector<int>& primitives);

}  // namespace item3d
