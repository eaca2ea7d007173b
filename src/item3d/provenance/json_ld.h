// XMP packets of glTF documents: JSON-LD as restricted by KHR_xmp_json_ld.
#pragma once

#include "item3d/provenance/packet_metadata.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// True if properties can be added to `packet`: it must be an object whose context declares
/// prefixes.
bool is_json_ld_packet(const nlohmann::ordered_json& packet);

/// Reads a packet; sets PacketMetadata::problem if it is invalid.
PacketMetadata read_json_ld(const nlohmann::ordered_json& packet);

/// Writes the claim and its properties_of() into a packet. Other properties are kept.
void put_claim(nlohmann::ordered_json& packet, const nlohmann::json& claim);

/// Removes only the claim from a packet.
void remove_claim(nlohmann::ordered_json& packet);

}  // namespace item3d
