// Which UVs an edited material is baked into: the input's own wherever there are any.
#pragma once

#include "item3d/field/atlas/texture_set.h"
#include "item3d/field/atlas/uv_raster.h"
#include "item3d/field/surface_points.h"
#include "item3d/io/save.h"

#include <map>
#include <string>
#include <vector>

namespace item3d {

/// --uv names the first three, in this order.
enum class UvPolicy {
    automatic,  ///< keep for a material with textures, own_texels for one without
    keep,       ///< own UVs wherever there are any
    make_new,
    /// As automatic, and keep for materials without textures too: of a change of colour alone
    /// each place shows the same, whatever texels it shares. Vertex colours are such places'
    /// own, so where these differ the UVs are as of own_texels.
    recolored,
    own_texels,  ///< own UVs where each place of the surface has texels of its own, else new ones
};

struct Atlas {
    /// One a triangle of Geometry. Zeros for triangles that are not baked: those of materials that
    /// are not edited, and of all instances of a primitive but the first.
    std::vector<UvTriangle> triangles;
    std::vector<TextureSet> sets;
    /// New UVs of all primitives of remade sets (instances all have the same).
    std::map<int, PrimitiveEdit> primitives;

    bool has_shared_texels() const;
};

/// Width and height of the picture that a material is baked to: longest edge `texture_size`, or as
/// its base colour texture for 0; 1024 x 1024 without one; at most 4096. With a new UV map it is
/// square, and for 0 at least 1024: a small texture that was tiled or shared needs more texels when
/// each place of the surface gets its own.
std::pair<int, int> atlas_size(const Model& model, int material, int texture_size,
                               bool has_new_uvs = false);

/// How the material's textures show what lies beyond [0, 1]; repeating for a material without.
UvWrap wrap_of(const Model& model, int material);

/// Decides for each texture set, and says in a note what is not as usual. Sets that are to have new
/// UVs have none yet.
Atlas choose_uvs(const Model& model, const FieldSpace& space, const std::vector<int>& materials,
                 UvPolicy policy);

/// Has xatlas make the new UVs that were decided for. Throws InputError where it cannot.
void add_new_uvs(const Model& model, const FieldSpace& space, int texture_size, Atlas& atlas);

/// Both.
Atlas make_atlas(const Model& model, const FieldSpace& space, const std::vector<int>& materials,
                 int texture_size = 0, UvPolicy policy = UvPolicy::own_texels);

/// The primitive with new UVs: vertices split at the seams, tangents dropped.
Primitive apply(const PrimitiveEdit& edit, const Primitive& primitive);

}  // namespace item3d
