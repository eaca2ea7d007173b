// Saving of models and images; every write is atomic.
#pragma once

#include "item3d/io/edited_texture.h"
#include "item3d/provenance/provenance.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Writes by extension: .png (values clamped to [0, 1], 8 or 16 bits), .jpg, .hdr, .exr (float32,
/// or half). PNG and JPEG store the values unchanged: pass sRGB-encoded ones.
void save_image(const std::filesystem::path& path, const Image& image, int bits_per_channel = 8);

/// Changes of an edit to one material. A new texture resets the factors of its slot to 1 (base
/// colour, metallic, roughness, occlusion strength, normal scale), so that the texture's values
/// alone apply. The alpha factor stays if base_color is RGB. The occlusion channel is used if the
/// material had an occlusion texture, or if the channel is not 1 throughout.
struct MaterialEdit {
    EditedTexture base_color;          ///< RGB or RGBA
    EditedTexture metallic_roughness;  ///< occlusion, roughness, metallic
    EditedTexture normal;
    /// True if a channel of metallic_roughness is copied from the source's texture. The new image
    /// then becomes a JPEG only if the source's texture was a JPEG.
    bool keeps_orm_texels = false;
    /// True if all images have the source's texels where nothing was edited. They are then written
    /// losslessly.
    bool keeps_texels = false;
    /// base_color includes the vertex colours' factors, so primitives with it lose COLOR_0.
    bool includes_vertex_colors = true;
    /// The material's occlusion texture stays unchanged, regardless of metallic_roughness.
    bool keeps_occlusion = false;
    /// The material stops emitting.
    bool removes_emission = false;
    /// Alpha mode and factor become opaque.
    bool makes_opaque = false;
    /// Removed extensions of the material, by name.
    std::vector<std::string> removed_extensions;
};

/// New UVs of one primitive. Seams split vertices, so source_vertices gives the old vertex that
/// each new vertex copies. Edited textures use the new UVs (TEXCOORD_0); unedited textures of the
/// material keep the old ones, which move to another set. Primitives of an edited material without
/// new UVs keep theirs.
struct PrimitiveEdit {
    std::vector<std::uint32_t> source_vertices;  ///< new vertex -> old vertex
    std::vector<Vec2> uvs;                       ///< one for each new vertex
    std::vector<std::uint32_t> indices;          ///< three for each triangle, into new vertices
};

struct ModelEdit {
    std::map<int, MaterialEdit> materials;    ///< by index into Model::materials
    std::map<int, PrimitiveEdit> primitives;  ///< by index into Model::primitives
};

/// Writes `model` with the edit applied: .glb, .gltf (+ .bin and PNGs beside it), or .obj (+ .mtl
/// and PNGs). A glTF source is patched: everything unedited (nodes, names, animations, skins,
/// cameras, other materials, unknown extensions, extras) stays byte for byte or value for value.
/// Other sources are written as a new, minimal document. provenance: description of edits from
/// sentences, which is written to the glTF and to the textures of the edit (io/image_claims.h,
/// io/gltf/claims.h).
void save_model(const std::filesystem::path& path, const Model& model, const ModelEdit& edit = {},
                const Provenance& provenance = {});

}  // namespace item3d
