#include "item3d/provenance/json_ld.h"

#include "item3d/provenance/xmp_names.h"

#include <string>
#include <string_view>
#include <utility>

namespace item3d {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* context_key = "@context";
/// Maximum nesting of objects; a claim has three levels.
constexpr int deepest_object = 16;

/// Returns the prefix that the packet's context declares for a namespace; empty if there is none.
std::string prefix_of(const ordered_json& packet, std::string_view space) {
    for (const auto& [prefix, iri] : packet.at(context_key).items())
        if (iri.is_string() && iri.get_ref<const std::string&>() == space) return prefix;
    return "";
}

/// Returns prefix_of() if it is not empty. Otherwise declares the prefix `wanted`, with a number if
/// that name is taken.
std::string declared_prefix(ordered_json& packet, std::string_view space, std::string_view wanted) {
    const std::string found = prefix_of(packet, space);
    if (!found.empty()) return found;
    ordered_json& context = packet[context_key];
    std::string prefix(wanted);
    for (int number = 2; context.contains(prefix); ++number)
        prefix = std::string(wanted) + std::to_string(number);
    context[prefix] = std::string(space);
    return prefix;
}

ordered_json to_json_ld(const json& value, const std::string& prefix) {
    if (value.is_array()) {
        ordered_json list = ordered_json::array();
        for (const json& item : value)
            list.push_back(to_json_ld(item, prefix));
        return ordered_json{{"@list", std::move(list)}};
    }
    if (value.is_object()) {
        ordered_json object = ordered_json::object();
        for (const auto& [key, field] : value.items())
            object[prefix + ":" + key] = to_json_ld(field, prefix);
        return object;
    }
    return value;
}

/// Converts a value of JSON-LD to a claim's JSON. Values that a claim cannot contain become null.
json from_json_ld(const ordered_json& value, const std::string& prefix, int depth = 0) {
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_object() || depth > deepest_object) return nullptr;
    for (const char* array : {"@list", "@set"}) {
        const auto items = value.find(array);
        if (items == value.end()) continue;
        if (!items->is_array()) return nullptr;
        json list = json::array();
        for (const ordered_json& item : *items)
            list.push_back(from_json_ld(item, prefix, depth + 1));
        return list;
    }
    json object = json::object();
    for (const auto& [key, field] : value.items())
        if (key.starts_with(prefix + ":"))
            object[key.substr(prefix.size() + 1)] = from_json_ld(field, prefix, depth + 1);
    return object;
}

void append_text(const ordered_json& value, std::string& text) {
    if (!value.is_string() || value.get_ref<const std::string&>().empty()) return;
    text += (text.empty() ? "" : "; ") + value.get<std::string>();
}

/// Returns the text of a property. The items of a list, or alternatives, are joined by "; ".
std::string text_of_property(const ordered_json& packet, std::string_view space,
                             std::string_view name) {
    const std::string prefix = prefix_of(packet, space);
    if (prefix.empty()) return "";
    const auto found = packet.find(prefix + ":" + std::string(name));
    if (found == packet.end()) return "";
    std::string text;
    append_text(*found, text);
    if (!found->is_object()) return text;
    for (const auto& [key, value] : found->items()) {
        if (value.is_array())
            for (const ordered_json& item : value)
                append_text(item, text);
        else if (key == "@value")
            append_text(value, text);
        else if (value.is_object() && value.contains("@value"))
            append_text(value["@value"], text);
    }
    return text;
}

}  // namespace

bool is_json_ld_packet(const ordered_json& packet) {
    return packet.is_object() && packet.contains(context_key) && packet.at(context_key).is_object();
}

PacketMetadata read_json_ld(const ordered_json& packet) {
    PacketMetadata metadata;
    if (!is_json_ld_packet(packet)) {
        metadata.problem = "its KHR_xmp_json_ld packet has no @context";
        return metadata;
    }
    const std::string prefix = prefix_of(packet, xmp::item3d);
    const auto claim = prefix.empty() ? packet.end() : packet.find(prefix + ":claim");
    if (claim != packet.end()) metadata.claim = from_json_ld(*claim, prefix);
    metadata.source_type = text_of_property(packet, xmp::iptc, "DigitalSourceType");
    metadata.creator = text_of_property(packet, xmp::dublin_core, "creator");
    metadata.rights = text_of_property(packet, xmp::dublin_core, "rights");
    metadata.usage_terms = text_of_property(packet, xmp::rights, "UsageTerms");
    return metadata;
}

void put_claim(ordered_json& packet, const json& claim) {
    for (const PacketProperty& property : properties_of(claim)) {
        const std::string prefix = declared_prefix(packet, property.space, property.prefix);
        const std::string key = prefix + ":" + std::string(property.name);
        packet.erase(key);
        if (!property.value.empty()) packet[key] = property.value;
    }
    const std::string prefix = declared_prefix(packet, xmp::item3d, "item3d");
    packet[prefix + ":claim"] = to_json_ld(claim, prefix);
}

void remove_claim(ordered_json& packet) {
    if (!is_json_ld_packet(packet)) return;
    const std::string prefix = prefix_of(packet, xmp::item3d);
    if (!prefix.empty()) packet.erase(prefix + ":claim");
}

}  // namespace item3d
