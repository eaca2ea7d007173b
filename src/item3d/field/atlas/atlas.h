// The choice of UV maps for baking: the input's own wherever possible.
#pragma once

#include "item3d/field/atlas/texture_set.h"
#include "item3d/field/atlas/uv_raster.h"
#include "item3d/field/surface_points.h"
#include "item3d/io/save.h"

#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Policies of the choice of UV maps; --uv names the first three, in this order.
enum class UvPolicy {
    automatic,  ///< `keep` for a material with textures, `own_texels` for one without
    keep,       ///< own UVs where they exist
    make_new,
    /// Same as `automatic`, but `keep` also for materials without textures: points that share a
    /// texel all get the same change of colour, so sharing does no harm. Where vertex colours of
    /// such points differ, same as `own_texels`.
    recolored,
    own_texels,  ///< own UVs where no two surface points share a texel, else new ones
};

struct Atlas {
    /// One for each triangle of Geometry. Zeros for triangles that are not baked: those of unedited
    /// materials, and of all instances of a primitive but the first.
    std::vector<UvTriangle> triangles;
    std::vector<TextureSet> sets;
    /// New UVs of all primitives in the sets that get a new UV map (the same for all instances).
    std::map<int, PrimitiveEdit> primitives;

    bool has_shared_texels() const;
};

/// Returns width and height of a material's baked image: longest edge `texture_size`, or for 0 the
/// size of its base colour texture; 1024 x 1024 without one; at most 4096. With a new UV map the
/// image is square, and for 0 at least 1024: a small texture that was tiled or shared needs more
/// texels when each surface point gets its own.
std::pair<int, int> atlas_size(const Model& model, int material, int texture_size,
                               bool has_new_uvs = false);

/// Returns the wrap modes of the material's textures; repeat for a material without textures.
UvWrap wrap_of(const Model& model, int material);

/// Chooses UVs for each texture set, and logs a note of unusual choices. Leaves new UVs to
/// add_new_uvs().
Atlas choose_uvs(const Model& model, const FieldSpace& space, const std::vector<int>& materials,
                 UvPolicy policy);

/// Computes the chosen new UVs with xatlas. Throws InputError where xatlas fails.
void add_new_uvs(const Model& model, const FieldSpace& space, int texture_size, Atlas& atlas);

/// Calls choose_uvs() and add_new_uvs().
Atlas make_atlas(const Model& model, const FieldSpace& space, const std::vector<int>& materials,
                 int texture_size = 0, UvPolicy policy = UvPolicy::own_texels);

/// Returns the primitive with new UVs: vertices split at the seams, tangents dropped.
Primitive apply(const PrimitiveEdit& edit, const Primitive& primitive);

}  // namespace item3d
