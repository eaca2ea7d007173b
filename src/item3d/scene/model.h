// A model as the renderer and the editor use it, independent of its file format.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"
#include "item3d/scene/image_coding.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

enum class Wrap { repeat, mirrored_repeat, clamp_to_edge };

/// An image with its sampler. Unreadable images are not in Model::textures: materials that refer to
/// them have -1 in that slot and keep their factors.
struct Texture {
    std::string name;
    Image image;
    int bits_per_channel = 8;
    Wrap wrap_u = Wrap::repeat;
    Wrap wrap_v = Wrap::repeat;
    /// Encoding of an edited copy of this image in its own file format.
    ImageCoding coding = {};
    /// The image's file, to be embedded unchanged in a new document (PNG, JPEG or WebP, as `coding`
    /// says); null if there is none.
    std::shared_ptr<const std::vector<std::uint8_t>> file = {};
    /// True for glTF's NEAREST magnification, which shows each texel as a square of one colour.
    bool nearest = false;
};

/// glTF's metallic-roughness material. Texture members are indices into Model::textures; -1 means
/// none. Texture values multiply the factors. Factors are linear; base colour textures are sRGB.
/// The members ..._uvs select the UV map of a texture: 0 selects Primitive::uvs, and k > 0 selects
/// Primitive::further_uvs[k - 1]. The base colour always uses 0.
struct Material {
    std::string name;
    Vec4 base_color_factor{1.0f};
    int base_color_texture = -1;
    /// Name of the base colour's image if the image cannot be read, else empty.
    std::string missing_base_color;
    float metallic_factor = 1.0f;
    float roughness_factor = 1.0f;
    /// Roughness in G and metallic in B, linear.
    int metallic_roughness_texture = -1;
    int metallic_roughness_uvs = 0;
    /// Occlusion in R, linear; may be the same texture as metallic_roughness_texture.
    int occlusion_texture = -1;
    int occlusion_uvs = 0;
    float occlusion_strength = 1.0f;
    /// Normals in tangent space, +Y up (OpenGL), linear.
    int normal_texture = -1;
    int normal_uvs = 0;
    float normal_scale = 1.0f;
    Vec3 emissive_factor{0.0f};
    int emissive_texture = -1;
    int emissive_uvs = 0;
    enum class Alpha { opaque, mask, blend } alpha = Alpha::opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    /// True if the material emits its base colour, independent of light (KHR_materials_unlit).
    bool unlit = false;
    /// Names of the material's extensions in the file that are not read, although viewers may show
    /// them (KHR_materials_transmission, ...).
    std::vector<std::string> other_extensions;
};

/// The triangles of one primitive of one node, in world space (node transforms applied).
struct Primitive {
    std::string name;
    std::vector<Vec3> positions;
    /// Normals of unit length; never empty. If the file has none, they are computed: flat for glTF
    /// (each corner then becomes a vertex of its own), smooth within each smoothing group for OBJ
    /// (area-weighted sums of face normals).
    std::vector<Vec3> normals;
    /// Empty when the file has none. glTF's convention: (0, 0) is the top left corner of the image.
    std::vector<Vec2> uvs;
    /// UV maps that the material's textures use besides `uvs`. Each is as long as positions, or
    /// empty if the file does not have it.
    std::vector<std::vector<Vec2>> further_uvs;
    /// Unit tangent and handedness in w, for the UV map of the normal texture; empty when the file
    /// has none.
    std::vector<Vec4> tangents;
    /// Linear RGBA factors of the base colour; empty when the file has none.
    std::vector<Vec4> colors;
    /// Three for each triangle, each below positions.size(); counter-clockwise is the front.
    std::vector<std::uint32_t> indices;
    /// Indices into Model::groups, one for each triangle; empty if the file has no groups.
    std::vector<int> triangle_groups;
    /// Index into Model::materials (always valid: there is a default material).
    int material = 0;
    /// Indices in the source document; -1 if the model is not from glTF.
    int source_mesh = -1;
    int source_primitive = -1;
    int source_node = -1;
    /// True if the node's transform mirrors. The order of the triangles' corners was then reversed,
    /// so that the triangles face outwards.
    bool is_mirrored = false;
};

/// An appearance variant of a file (KHR_materials_variants).
struct MaterialVariant {
    std::string name;
    /// Ascending indices into Model::materials, of those that the variant uses.
    std::vector<int> materials;
};

class SourceDocument;

struct Model {
    std::string name;
    std::vector<Primitive> primitives;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    /// Distinct sets of group and object names ("g" and "o" of an OBJ file). Each triangle has one
    /// set.
    std::vector<std::vector<std::string>> groups;
    /// Offset subtracted from the file's positions (far_origin.h); zero for all but models far from
    /// their origin. Writers add it again, in double precision.
    glm::dvec3 origin{0.0};
    /// Empty if the file has none. Primitives have the materials of the selected variant, or their
    /// default materials if none is selected.
    std::vector<MaterialVariant> variants;
    /// The loaded document, for writing an edited copy that keeps everything unedited. Null for
    /// generated models.
    std::shared_ptr<const SourceDocument> source;

    std::size_t triangle_count() const;
    /// Returns the corners of the axis-aligned bounding box of all positions.
    std::array<Vec3, 2> bounds() const;
};

/// Replaces each normal by the area-weighted sum of face normals over all vertices at its position.
void compute_smooth_normals(Primitive& primitive);

}  // namespace item3d
