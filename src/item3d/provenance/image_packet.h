// XMP packets in image files: PNG (iTXt), JPEG (APP1), WebP (chunk "XMP "), KTX2 (a key and value).
#pragma once

#include "item3d/core/files.h"

#include <optional>
#include <span>
#include <string>

namespace item3d {

enum class PacketContainer { none, png, jpeg, webp, ktx2 };

/// Returns the container that the first bytes indicate; `none` for images whose packets are neither
/// read nor written.
PacketContainer packet_container(std::span<const std::uint8_t> image);

/// Returns the packet of an image; nullopt if it has none, or if the file is damaged before the
/// packet. Extended packets of JPEG (beyond 64 KB) are not read.
std::optional<std::string> find_packet(std::span<const std::uint8_t> image);

/// Returns the image with its packet replaced or added; pixels and other metadata stay. Returns the
/// image unchanged if it cannot hold the packet: if it has another format, or is a JPEG and the
/// packet exceeds 65502 bytes.
Bytes with_packet(std::span<const std::uint8_t> image, const std::string& packet);

/// Returns the SHA-256 of an image file without its packet, so that the packet can contain this
/// hash. A KTX2 file is hashed in the layout of ktx2_with_packet(). For formats without packets,
/// and damaged files, returns the hash of all bytes.
std::string image_sha256(std::span<const std::uint8_t> image);

}  // namespace item3d
