// Metadata read from a packet that any program may have written.
#pragma once

#include "item3d/provenance/claim.h"

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace item3d {

struct PacketMetadata {
    nlohmann::json claim;                      ///< item3d's claim, as read; null if none
    std::string source_type;                   ///< Iptc4xmpExt:DigitalSourceType
    std::string creator, rights, usage_terms;  ///< dc:creator, dc:rights, xmpRights:UsageTerms
    std::string problem;  ///< reason why the packet cannot be read; empty if it can
};

/// Standard property that repeats a fact of the claim.
struct PacketProperty {
    std::string_view space;
    std::string_view prefix;
    std::string_view name;
    std::string value;  ///< empty if the property is removed
};

/// Returns the standard properties of IPTC Photo Metadata 2025.1 (DigitalSourceType, AISystemUsed,
/// AISystemVersionUsed, AIPromptInformation) and XMP (ModifyDate). They replace the same properties
/// of the source file. A reconstruction has no AI properties.
std::vector<PacketProperty> properties_of(const nlohmann::json& claim);

}  // namespace item3d
