// XMP packets of images (ISO 16684-1, RDF/XML).
#pragma once

#include "item3d/provenance/packet_facts.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>

namespace item3d {

/// Larger packets are not read.
inline constexpr std::size_t largest_packet = std::size_t{4} << 20;

/// What a packet says; PacketFacts::problem where it is too large, no XML, or no XMP. UTF-8, UTF-16
/// and UTF-32 are read, bytes that are no UTF-8 replaced.
PacketFacts read_xmp(const std::string& packet);

/// `packet` (empty: none) with the claim and what properties_of() it says; all else stays, but an
/// earlier claim and earlier values of these properties. A packet that cannot be read is left out.
std::string xmp_with_claim(const std::string& packet, const nlohmann::json& claim);

}  // namespace item3d
