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

/// Writes an image in the format of the extension: .png (values clamped to [0, 1], 8 or 16 bits),
/// .jpg, .hdr, .exr (half if bits_per_channel is 16, else float32). PNG and JPEG store the values
/// unchanged, so the values should be sRGB-encoded.
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
    /// True if all images have the source's texels where nothing was edited. The images are then
    /// written losslessly.
    bool keeps_texels = false;
    /// True if base_color includes the factors of the vertex colours. The material's primitives
    /// then lose COLOR_0.
    bool includes_vertex_colors = true;
    /// True if the material's occlusion texture stays unchanged, regardless of metallic_roughness.
    bool keeps_occlusion = false;
    /// True if the edit removes the material's emission.
    bool removes_emission = false;
    /// True if the edit makes the material's alpha mode and factor opaque.
    bool makes_opaque = false;
    /// Names of the extensions that the edit removes from the material.
    std::vector<std::string> removed_extensions;
};

/// New UVs of one primitive. Seams split vertices, so source_vertices gives the old vertex that
/// each new vertex copies. Edited textures use the new UVs (TEXCOORD_0); unedited textures of the
/// material keep the old ones, which move to another set. If a primitive of an edited material gets
/// no new UVs, it keeps its old ones.
struct PrimitiveEdit {
    std::vector<std::uint32_t> source_vertices;  ///< the old vertex, for each new vertex
    std::vector<Vec2> uvs;                       ///< one for each new vertex
    std::vector<std::uint32_t> indices;          ///< of new vertices; three for each triangle
};

struct ModelEdit {
    std::map<int, MaterialEdit> materials;    ///< by index into Model::materials
    std::map<int, PrimitiveEdit> primitives;  ///< by index into Model::primitives
};

/// Writes `model` with the edit applied: .glb, .gltf (with .bin and image files beside it), or .obj
/// (with .mtl and image files). A glTF source is patched: everything unedited (nodes, names,
/// animations, skins, cameras, other materials, unknown extensions, extras) keeps its bytes or its
/// values. Other sources are written as a new, minimal document. provenance: description of edits
/// that were made from sentences; it is written to the glTF and to the textures of the edit
/// (io/image_claims.h, io/gltf/claims.h).
void save_model(const std::filesystem::path& path, const Model& model, const ModelEdit& edit = {},
                const Provenance& provenance = {});

}  // namespace item3d
