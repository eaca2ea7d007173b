// MTL materials to the model's metallic-roughness ones. Internal to io.
#pragma once

#include "item3d/io/obj/mtl.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Adds materials and textures to a model; pictures that cannot be read are warnings.
///
/// Kd is linear and is replaced by map_Kd where there is one, as Blender and nvdiffrec do. Without
/// Pr, roughness follows Ns as in Blender (1 - sqrt(Ns / 1000)), else it is 0.5; without Pm,
/// metallic is 0. map_Pr and map_Pm that name one colour picture are its G and B, else grey
/// pictures. In nvdiffrec's dialect ("bsdf pbr") Ks and map_Ks are (occlusion, roughness,
/// metallic), of which occlusion counts the other way round and is left out. A bump map that is a
/// picture of heights is left out with a warning, one that is a normal map is used. d is opacity,
/// and counts before Tr, transparency; map_d of a picture of its own becomes the alpha of the base
/// colour's texture.
class ObjMaterials {
  public:
    /// folder: of the model, where pictures are looked for after that of the MTL file; subject: the
    /// OBJ file, for warnings.
    /// allowed: LoadOptions::texture_folders.
    ObjMaterials(Model& model, std::filesystem::path folder, std::string subject,
                 std::vector<std::filesystem::path> allowed);

    /// Returns the index of the new material in the model.
    int add(const MtlMaterial& source);

    /// Comes last. Where all materials are wholly transparent they are taken as opaque, with a
    /// warning: many programs write Tr 1 or d 0 for that. One among others is a warning.
    void make_visible();

  private:
    /// The picture, read once per name; null when it cannot be read.
    const Texture* read(const MtlMap& map);
    std::filesystem::path find_picture_file(const MtlMap& map) const;
    int add_texture(const Texture& texture, const MtlMap& map);
    int add_cut_out(const Texture* base, const Texture& opacity, const MtlMaterial& source);
    void set_base_color(const MtlMaterial& source, Material& material);
    void set_metallic_roughness(const MtlMaterial& source, Material& material);
    void set_normals(const MtlMaterial& source, Material& material);

    Model& model_;
    std::filesystem::path folder_;
    std::vector<std::filesystem::path> allowed_;
    std::string subject_;
    std::map<std::string, std::optional<Texture>> pictures_;
    std::map<std::pair<std::string, bool>, int> added_;
    std::vector<bool> has_opacity_map_;  ///< of the materials, in their order
};

}  // namespace item3d
