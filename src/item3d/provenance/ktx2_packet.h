// XMP packets among the keys and values of KTX 2.0 files. Internal to provenance.
#pragma once

#include "item3d/core/files.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace item3d {

/// The specification (2.0, of 2026) has no key for XMP and reserves all that begin with "KTX": this
/// is PNG's keyword.
inline constexpr std::string_view ktx2_packet_key = "XML:com.adobe.xmp";

bool is_ktx2(std::span<const std::uint8_t> image);

/// No value where the file has no packet or is damaged.
std::optional<std::string> find_ktx2_packet(std::span<const std::uint8_t> image);

/// The file laid out as the specification has it, with this packet (no value: none) in place of any
/// that it has; levels, codebooks, descriptor and other keys stay. Empty: it is damaged.
Bytes ktx2_with_packet(std::span<const std::uint8_t> image,
                       const std::optional<std::string>& packet);

}  // namespace item3d
