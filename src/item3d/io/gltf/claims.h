// Provenance claims in glTF documents (KHR_xmp_json_ld). Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/provenance/packet_metadata.h"
#include "item3d/provenance/provenance.h"

#include <string>
#include <vector>

namespace item3d {

inline constexpr const char* packets_extension = "KHR_xmp_json_ld";

/// Returns the packet of the document's asset; null if there is none.
const Json* asset_packet(const Json& json);

/// Reads the asset's packet, including its claim. Returns empty metadata if there is none.
PacketMetadata read_asset_packet(const Json& json);

/// Returns the XMP packet of the image of a material's texture; empty if there is none.
std::string packet_of_texture(const SourceDocument& document, const GltfObject& texture_info);

/// Returns image_sha256() of every image; an empty string for an unreadable image.
std::vector<std::string> image_hashes(const SourceDocument& document);

/// Returns the SHA-256 of a document's JSON, of the content of its buffer views, and of its other
/// chunks. Excludes the claim, and the images that the claim lists.
std::string document_sha256(const SourceDocument& document, const std::vector<ImageClaim>& claimed);

/// Writes a claim into the asset's packet of `written`. The claim lists the edits of the source's
/// claim, then the edits of `provenance`. written: the document as it will be in its file. Images
/// that the source lacks count as edited.
void put_claim(const Provenance& provenance, const SourceDocument& source, SourceDocument& written);

}  // namespace item3d
