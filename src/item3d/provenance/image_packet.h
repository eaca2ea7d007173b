// XMP packets in the files of images: PNG (iTXt), JPEG (APP1), WebP (chunk "XMP "),
// KTX2 (a key and value).
#pragma once

#include "item3d/core/files.h"

#include <optional>
#include <span>
#include <string>

namespace item3d {

enum class PacketContainer { none, png, jpeg, webp, ktx2 };

/// By the first bytes; none: an image of which packets are not read or written.
PacketContainer packet_container(std::span<const std::uint8_t> image);

/// The packet of an image; no value where it has none, or is damaged before it. Extended packets of
/// JPEG (beyond 64 KB) are not read.
std::optional<std::string> find_packet(std::span<const std::uint8_t> image);

/// The image with this packet in place of any that it has; its pixels and all else stay. The image
/// as it is where it can hold none: another format, or a packet beyond a JPEG's 65502 bytes.
Bytes with_packet(std::span<const std::uint8_t> image, const std::string& packet);

/// SHA-256 of all that an image's file has but its packet, so that it can stand in the packet; of
/// KTX2, as ktx2_with_packet() lays it out. Of formats without packets, and damaged files, that of
/// all bytes.
std::string image_sha256(std::span<const std::uint8_t> image);

}  // namespace item3d
