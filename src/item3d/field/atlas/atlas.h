// The choice of the UV maps for baking. The model's own UV maps are used wherever possible.
#pragma once

#include "item3d/field/atlas/texture_set.h"
#include "item3d/field/atlas/uv_raster.h"
#include "item3d/field/surface_points.h"
#include "item3d/io/save.h"

#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Policies for the choice of UV maps. The option --uv has the first three, in this order.
enum class UvPolicy {
    automatic,  ///< `keep` for materials with textures, `own_texels` for others
    keep,       ///< own UVs if the material has any, else new UVs
    make_new,
    /// Same as `keep`, but same as `own_texels` for materials without textures whose vertex colours
    /// vary. This is for edits in which points that share a texel all get the same change of
    /// colour, so that sharing does no harm.
    recolored,
    own_texels,  ///< own UVs if no two surface points share a texel, else new UVs
};

struct Atlas {
    /// UVs for each triangle of Geometry. They are zeros for triangles that are not baked, which
    /// are those of unedited materials and those of all instances of a primitive but the first.
    std::vector<UvTriangle> triangles;
    std::vector<TextureSet> sets;
    /// New UVs of all primitives in the sets that get a new UV map. All instances of a primitive
    /// get the same UVs.
    std::map<int, PrimitiveEdit> primitives;

    bool has_shared_texels() const;
};

/// Returns the width and height of a material's baked image. Its shape is that of the base colour
/// texture. Its longest edge is `texture_size`; if that is 0, the image has the base colour
/// texture's size, or 1024 x 1024 if there is none. The longest edge is at most 4096. With a new UV
/// map the image is square, and if `texture_size` is 0, it has at least 1024 texels along an edge,
/// because a small texture that was tiled or shared needs more texels when each surface point gets
/// its own.
std::pair<int, int> atlas_size(const Model& model, int material, int texture_size,
                               bool has_new_uvs = false);

/// Returns the wrap modes of the material's textures. For a material without textures they are
/// `repeat`.
UvWrap wrap_of(const Model& model, int material);

/// Chooses the UVs of each texture set, and prints a note of unusual choices. Does not compute new
/// UVs, which add_new_uvs() does.
Atlas choose_uvs(const Model& model, const FieldSpace& space, const std::vector<int>& materials,
                 UvPolicy policy);

/// Computes the new UVs with xatlas. Throws InputError if xatlas fails.
void add_new_uvs(const Model& model, const FieldSpace& space, int texture_size, Atlas& atlas);

/// Calls choose_uvs() and add_new_uvs().
Atlas make_atlas(const Model& model, const FieldSpace& space, const std::vector<int>& materials,
                 int texture_size = 0, UvPolicy policy = UvPolicy::own_texels);

/// Returns the primitive with new UVs. Its vertices are split at the seams, and it has no tangents.
Primitive apply(const PrimitiveEdit& edit, const Primitive& primitive);

}  // namespace item3d
