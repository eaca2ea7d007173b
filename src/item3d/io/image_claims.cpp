#include "item3d/io/image_claims.h"

#include "item3d/core/progress.h"
#include "item3d/io/gltf/claims.h"
#include "item3d/io/gltf/uv_layouts.h"
#include "item3d/provenance/image_packet.h"
#include "item3d/provenance/xmp.h"

#include <optional>
#include <set>
#include <string>
#include <utility>

namespace item3d {
namespace {

/// Packets of the source's textures in a material's slots.
class SourcePackets {
  public:
    SourcePackets(const Model& model, int material) : model_(model) {
        if (!model.source) return;
        const GltfObject root = root_of(*model.source);
        const auto index = static_cast<std::size_t>(material);
        if (index < root.list_size("materials")) slots_.emplace(root.item("materials", index));
    }

    std::string of(std::optional<GltfObject> TextureSlots::*slot, int texture) const {
        std::string packet;
        if (slots_ && (*slots_).*slot)
            packet = packet_of_texture(*model_.source, *((*slots_).*slot));
        else if (texture >= 0 && model_.textures[static_cast<std::size_t>(texture)].file)
            packet =
                find_packet(*model_.textures[static_cast<std::size_t>(texture)].file).value_or("");
        if (packet.empty()) return "";
        const std::string problem = read_xmp(packet).problem;
        if (problem.empty()) return packet;
        warn("a texture of the source: " + problem + "; this packet is left out");
        return "";
    }

  private:
    const Model& model_;
    std::optional<TextureSlots> slots_;
};

Bytes with_claim(const Bytes& image, const std::string& source, const Provenance& provenance) {
    const auto earlier = source.empty() ? nlohmann::json() : read_xmp(source).claim;
    nlohmann::json claim = make_claim(join_edits(edits_of(earlier), provenance.edits),
                                      {{"", "", image_sha256(image)}});
    if (provenance.key) provenance.key->sign(claim);
    Bytes written = with_packet(image, xmp_with_claim(source, claim));
    // with_packet() returns the image unchanged if the packet is too large for a JPEG. The source's
    // packet is then left out.
    if (written == image && !source.empty())
        written = with_packet(image, xmp_with_claim("", claim));
    return written;
}

}  // namespace

void put_claims(const Provenance& provenance, const Model& model, const ModelEdit& edit) {
    if (provenance.edits.empty()) return;
    std::set<const void*> seen;
    const auto put = [&](EditedTexture texture, const std::string& source) {
        texture.set_encoded(with_claim(texture.encoded(), source, provenance));
    };
    const auto is_new = [&](const EditedTexture& texture) {
        return texture && seen.insert(texture.identity()).second;
    };
    for (const auto& [index, changes] : edit.materials) {
        const Material& material = model.materials[static_cast<std::size_t>(index)];
        const SourcePackets packets(model, index);
        if (is_new(changes.base_color))
            put(changes.base_color,
                packets.of(&TextureSlots::base_color, material.base_color_texture));
        if (is_new(changes.metallic_roughness))
            put(changes.metallic_roughness,
                packets.of(&TextureSlots::metallic_roughness, material.metallic_roughness_texture));
        if (is_new(changes.normal))
            put(changes.normal, packets.of(&TextureSlots::normal, material.normal_texture));
    }
}

}  // namespace item3d
