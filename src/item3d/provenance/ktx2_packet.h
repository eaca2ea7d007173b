// XMP packets in the key/value data of KTX 2.0 files. Internal to provenance.
#pragma once

#include "item3d/core/files.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace item3d {

/// Key of the packet: PNG's keyword for XMP. The KTX specification (2.0, of 2026) defines no key
/// for XMP, and reserves all keys that begin with "KTX".
inline constexpr std::string_view ktx2_packet_key = "XML:com.adobe.xmp";

bool is_ktx2(std::span<const std::uint8_t> image);

/// Returns the packet; nullopt if the file has none or is damaged.
std::optional<std::string> find_ktx2_packet(std::span<const std::uint8_t> image);

/// Returns the file in the specification's layout, with its packet replaced, or removed if `packet`
/// is nullopt. Levels, codebooks, descriptor and other keys stay. Returns no bytes if the file is
/// damaged.
Bytes ktx2_with_packet(std::span<const std::uint8_t> image,
                       const std::optional<std::string>& packet);

}  // namespace item3d
