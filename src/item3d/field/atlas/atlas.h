// Which UVs an edited material is baked into: the input's own wherever there are any.
#pragma once

#include "item3d/field/atlas/uv_raster.h"
#include "item3d/field/surface_points.h"
#include "item3d/io/save.h"

#include <map>
#include <string>
#include <vector>

namespace item3d {

enum class UvPolicy {
    automatic,  ///< keep for a material with textures, own_texels for one without
    keep,       ///< own UVs wherever there are any
    make_new,
    own_texels,  ///< own UVs where each place of the surface has texels of its own, else new ones
};

struct Atlas {
    /// One a triangle of Geometry. Zeros for triangles that are not baked: those of materials that
    /// are not edited, and of all instances of a primitive but the first.
    std::vector<UvTriangle> triangles;
    /// Triangles (indices into `triangles`) that are baked, by edited material.
    std::map<int, std::vector<std::int32_t>> material_triangles;
    /// Materials whose own UVs show a texel in several places, or give some no texels, in words.
    std::map<int, std::string> shared;
    /// Materials whose UVs are new, and why.
    std::map<int, std::string> remade;
    /// New UVs of all primitives of remade materials (instances all have the same).
    std::map<int, PrimitiveEdit> primitives;

    bool is_own(int material) const { return remade.count(material) == 0; }
};

/// Why the UVs of primitives that share a texture can't be baked into, in words ("it has no UV
/// map", "its UV map overlaps itself", ...); empty when they can. UVs beyond [0, 1] are no problem
/// by themselves where the texture repeats: what counts is whether each texel shows one place. Nor
/// do triangles overlap that lie on each other in space as well, such as both sides of a leaf.
std::string find_uv_problem(const Model& model, const std::vector<int>& primitives);

/// Width and height of the picture that a material is baked to: longest edge `texture_size`, or as
/// its base colour texture for 0; 1024 x 1024 without one; at most 4096. With a new UV map it is
/// square, and for 0 at least 1024: a small texture that was tiled or shared needs more texels when
/// each place of the surface gets its own.
std::pair<int, int> atlas_size(const Model& model, int material, int texture_size,
                               bool has_new_uvs = false);

/// How the material's textures show what lies beyond [0, 1]; repeating for a material without.
UvWrap wrap_of(const Model& model, int material);

/// Decides for each material, has xatlas make new UVs where needed, and says so in a note.
Atlas make_atlas(const Model& model, const FieldSpace& space, const std::vector<int>& materials,
                 int texture_size = 0, UvPolicy policy = UvPolicy::own_texels);

/// The primitive with new UVs: vertices split at the seams, tangents dropped.
Primitive apply(const PrimitiveEdit& edit, const Primitive& primitive);

}  // namespace item3d
