// Formats that are recognised but not read, for messages. Internal to io.
#pragma once

#include <cstdint>
#include <span>

namespace item3d {

/// Returns "a DDS texture" and the like; nullptr for other bytes.
const char* foreign_format(std::span<const std::uint8_t> bytes);

}  // namespace item3d
