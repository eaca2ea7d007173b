// Formats that are recognised but not read, for messages. Internal to io.
#pragma once

#include <cstdint>
#include <span>

namespace item3d {

/// Returns a description such as "a DDS texture"; nullptr if the bytes have no such format.
const char* foreign_format(std::span<const std::uint8_t> bytes);

}  // namespace item3d
