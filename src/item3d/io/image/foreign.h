// Formats that are known by name alone, for messages. Internal to io.
#pragma once

#include <cstdint>
#include <span>

namespace item3d {

/// "a DDS texture" and the like; nullptr where the bytes are none of these.
const char* foreign_format(std::span<const std::uint8_t> bytes);

}  // namespace item3d
