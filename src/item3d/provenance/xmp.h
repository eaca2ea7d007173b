// XMP packets of images (ISO 16684-1, RDF/XML).
#pragma once

#include "item3d/provenance/packet_metadata.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>

namespace item3d {

/// Maximum size of a packet that is read, in bytes.
inline constexpr std::size_t largest_packet = std::size_t{4} << 20;

/// Reads a packet; sets PacketMetadata::problem if it is too large, not XML, or not XMP. The text
/// may be UTF-8, UTF-16 or UTF-32. Invalid UTF-8 is replaced.
PacketMetadata read_xmp(const std::string& packet);

/// Returns `packet`, or a new packet if it is empty, with the claim and its properties_of(). They
/// replace an earlier claim and earlier values of these properties; all else stays. A packet that
/// cannot be read is dropped.
std::string xmp_with_claim(const std::string& packet, const nlohmann::json& claim);

}  // namespace item3d
