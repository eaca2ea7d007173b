// Claims in glTF documents (KHR_xmp_json_ld). Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/provenance/packet_facts.h"
#include "item3d/provenance/provenance.h"

#include <string>
#include <vector>

namespace item3d {

inline constexpr const char* packets_extension = "KHR_xmp_json_ld";

/// The packet of the document's asset; null: none.
const Json* asset_packet(const Json& json);

/// The asset's packet, the claim in it among the rest. Nothing where there is none.
PacketFacts read_asset_packet(const Json& json);

/// The XMP packet of the picture that a material's texture shows; empty: it has none.
std::string packet_of_texture(const SourceDocument& document, const GltfObject& texture_info);

/// image_sha256() of every image; empty for those that cannot be read.
std::vector<std::string> image_hashes(const SourceDocument& document);

/// SHA-256 of all of a document but the claim and the bytes of the images that the claim lists: the
/// JSON, what buffer views hold, and other chunks.
std::string document_sha256(const SourceDocument& document, const std::vector<ImageClaim>& claimed);

/// Puts a claim of `provenance`, after the source's own, into the asset's packet of `written`: the
/// document as it will stand in its file. Edited images are those that the source does not have.
void put_claim(const Provenance& provenance, const SourceDocument& source, SourceDocument& written);

}  // namespace item3d
