// Conversion of MTL materials to metallic-roughness. Internal to io.
#pragma once

#include "item3d/io/obj/mtl.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Adds materials and textures to a model; warns of unreadable images.
///
/// Kd is linear. If there is a map_Kd, it replaces Kd, as in Blender and nvdiffrec. Without Pr,
/// roughness follows Ns as in Blender (1 - sqrt(Ns / 1000)), else it is 0.5; without Pm, metallic
/// is 0. If map_Pr and map_Pm name the same colour image, its G is the roughness and its B is
/// metallic; otherwise the maps are grey images. In nvdiffrec's dialect ("bsdf pbr") Ks and map_Ks
/// are (occlusion, roughness, metallic), where occlusion is inverted and ignored. A bump map with
/// heights is ignored with a warning; a bump map with normals is used. The opacity d overrides the
/// transparency Tr. A map_d in a separate image becomes the alpha of the base colour's texture.
class ObjMaterials {
  public:
    /// folder: folder of the model, which is searched for images after the folder of the MTL file;
    /// subject: name of the OBJ file in warnings; allowed: LoadOptions::texture_folders.
    ObjMaterials(Model& model, std::filesystem::path folder, std::string subject,
                 std::vector<std::filesystem::path> allowed);

    /// Returns the index of the new material in the model.
    int add(const MtlMaterial& source);

    /// Must be called last. Makes all materials opaque, with a warning, if all are wholly
    /// transparent: many programs write Tr 1 or d 0 for opaque materials. Warns if only some
    /// materials are transparent.
    void make_visible();

  private:
    /// Returns the image, which is read once for each name; null when it cannot be read.
    const Texture* read(const MtlMap& map);
    std::filesystem::path find_image_file(const MtlMap& map) const;
    int add_texture(const Texture& texture, const MtlMap& map);
    int add_cut_out(const Texture* base, const Texture& opacity, const MtlMaterial& source);
    void set_base_color(const MtlMaterial& source, Material& material);
    void set_metallic_roughness(const MtlMaterial& source, Material& material);
    void set_normals(const MtlMaterial& source, Material& material);

    Model& model_;
    std::filesystem::path folder_;
    std::vector<std::filesystem::path> allowed_;
    std::string subject_;
    std::map<std::string, std::optional<Texture>> images_;
    std::map<std::pair<std::string, bool>, int> added_;
    std::vector<bool> has_opacity_map_;  ///< by material
};

}  // namespace item3d
