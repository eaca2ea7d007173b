// XMP packets of glTF documents: JSON-LD, as KHR_xmp_json_ld restricts it.
#pragma once

#include "item3d/provenance/packet_facts.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// Whether other properties can be written beside those of `packet`: an object with a context of
/// prefixes.
bool is_json_ld_packet(const nlohmann::ordered_json& packet);

/// What a packet says; PacketFacts::problem where it is none.
PacketFacts read_json_ld(const nlohmann::ordered_json& packet);

/// Writes the claim and what properties_of() it says into a packet; all else stays.
void put_claim(nlohmann::ordered_json& packet, const nlohmann::json& claim);

/// Takes the claim, but nothing else, out of a packet.
void remove_claim(nlohmann::ordered_json& packet);

}  // namespace item3d
