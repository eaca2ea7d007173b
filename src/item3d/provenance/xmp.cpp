#include "item3d/provenance/xmp.h"

#include "item3d/provenance/xmp_names.h"

#include <pugixml.hpp>

#include <cstring>
#include <sstream>
#include <string_view>
#include <vector>

namespace item3d {
namespace {

using nlohmann::json;

/// Maximum nesting of elements; legitimate packets have about ten levels.
constexpr int deepest_element = 64;
constexpr unsigned parse_options = pugi::parse_default | pugi::parse_ws_pcdata_single;

std::string_view local_name(std::string_view name) {
    const std::size_t colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

/// Returns the namespace of a prefixed name in scope at `place`; empty if none is declared.
std::string_view namespace_of(const pugi::xml_node& place, std::string_view name) {
    const std::size_t colon = name.find(':');
    const std::string declaration =
        colon == std::string_view::npos ? "xmlns" : "xmlns:" + std::string(name.substr(0, colon));
    for (pugi::xml_node node = place; node; node = node.parent())
        if (const auto attribute = node.attribute(declaration.c_str())) return attribute.value();
    return "";
}

bool is_named(const pugi::xml_node& place, std::string_view name, std::string_view space,
              std::string_view local) {
    return local_name(name) == local && namespace_of(place, name) == space;
}

bool is_named(const pugi::xml_node& node, std::string_view space, std::string_view local) {
    return node.type() == pugi::node_element && is_named(node, node.name(), space, local);
}

class DepthCheck : public pugi::xml_tree_walker {
  public:
    bool for_each(pugi::xml_node&) override { return depth() <= deepest_element; }
};

/// A parsed packet with its rdf:RDF element, or the reason why there is none.
struct XmpDocument {
    pugi::xml_document xml;
    pugi::xml_node rdf;
    std::string problem;
};

pugi::xml_node find_rdf(const pugi::xml_document& xml) {
    for (const pugi::xml_node root : xml.children()) {
        if (is_named(root, xmp::rdf, "RDF")) return root;
        for (const pugi::xml_node child : root.children())
            if (is_named(child, xmp::rdf, "RDF")) return child;
    }
    return {};
}

void parse_packet(const std::string& packet, XmpDocument& document) {
    if (packet.size() > largest_packet) {
        document.problem = "its XMP packet is larger than 4 MiB";
        return;
    }
    const pugi::xml_parse_result result =
        document.xml.load_buffer(packet.data(), packet.size(), parse_options);
    DepthCheck check;
    if (!result)
        document.problem = std::string("its XMP packet is not valid XML: ") + result.description();
    else if (!document.xml.traverse(check))
        document.problem = "its XMP packet has elements nested more than 64 deep";
    else if (document.rdf = find_rdf(document.xml); !document.rdf)
        document.problem = "its XMP packet has no rdf:RDF";
}

std::vector<pugi::xml_node> descriptions_of(const pugi::xml_node& rdf) {
    std::vector<pugi::xml_node> found;
    for (const pugi::xml_node child : rdf.children())
        if (is_named(child, xmp::rdf, "Description")) found.push_back(child);
    return found;
}

/// Returns the rdf:Seq, rdf:Bag or rdf:Alt in an element; a null node if there is none.
pugi::xml_node array_in(const pugi::xml_node& element) {
    for (const pugi::xml_node child : element.children())
        for (const char* kind : {"Seq", "Bag", "Alt"})
            if (is_named(child, xmp::rdf, kind)) return child;
    return {};
}

/// Returns the text with invalid UTF-8 replaced.
std::string valid_text(const char* text) {
    const std::string dumped = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
    return json::parse(dumped).get<std::string>();
}

/// Converts structures to objects, with the local names of item3d's fields as keys, arrays to
/// lists, and all else to text.
json value_of(const pugi::xml_node& element) {
    if (const pugi::xml_node array = array_in(element)) {
        json list = json::array();
        for (const pugi::xml_node item : array.children())
            if (is_named(item, xmp::rdf, "li")) list.push_back(value_of(item));
        return list;
    }
    json object = json::object();
    const auto read_fields = [&](const pugi::xml_node& owner) {
        for (const pugi::xml_attribute attribute : owner.attributes())
            if (namespace_of(owner, attribute.name()) == xmp::item3d)
                object[std::string(local_name(attribute.name()))] = valid_text(attribute.value());
        for (const pugi::xml_node child : owner.children())
            if (child.type() == pugi::node_element &&
                namespace_of(child, child.name()) == xmp::item3d)
                object[valid_text(std::string(local_name(child.name())).c_str())] = value_of(child);
    };
    read_fields(element);
    for (const pugi::xml_node child : descriptions_of(element))
        read_fields(child);
    if (!object.empty()) return object;
    return valid_text(element.text().get());
}

/// Returns the text of a property, in which "; " joins the items of an array; empty if the property
/// is missing.
std::string text_of_property(const pugi::xml_node& rdf, std::string_view space,
                             std::string_view name) {
    for (const pugi::xml_node description : descriptions_of(rdf)) {
        for (const pugi::xml_attribute attribute : description.attributes())
            if (is_named(description, attribute.name(), space, name))
                return valid_text(attribute.value());
        for (const pugi::xml_node child : description.children()) {
            if (!is_named(child, space, name)) continue;
            const pugi::xml_node array = array_in(child);
            if (!array) return valid_text(child.text().get());
            std::string text;
            for (const pugi::xml_node item : array.children())
                if (const char* own = item.text().get(); *own != '\0')
                    text += (text.empty() ? "" : "; ") + valid_text(own);
            return text;
        }
    }
    return "";
}

json claim_of(const pugi::xml_node& rdf) {
    for (const pugi::xml_node description : descriptions_of(rdf))
        for (const pugi::xml_node child : description.children())
            if (is_named(child, xmp::item3d, "claim")) return value_of(child);
    return nullptr;
}

void remove_property(const pugi::xml_node& rdf, std::string_view space, std::string_view name) {
    for (pugi::xml_node description : descriptions_of(rdf)) {
        std::vector<pugi::xml_attribute> attributes;
        for (const pugi::xml_attribute attribute : description.attributes())
            if (is_named(description, attribute.name(), space, name))
                attributes.push_back(attribute);
        for (const pugi::xml_attribute& attribute : attributes)
            description.remove_attribute(attribute);
        std::vector<pugi::xml_node> children;
        for (const pugi::xml_node child : description.children())
            if (is_named(child, space, name)) children.push_back(child);
        for (const pugi::xml_node& child : children)
            description.remove_child(child);
    }
}

void write_value(pugi::xml_node element, const json& value) {
    if (value.is_array()) {
        pugi::xml_node list = element.append_child("rdf:Seq");
        for (const json& item : value)
            write_value(list.append_child("rdf:li"), item);
    } else if (value.is_object()) {
        element.append_attribute("rdf:parseType") = "Resource";
        for (const auto& [key, field] : value.items())
            write_value(element.append_child(("item3d:" + key).c_str()), field);
    } else if (value.is_string()) {
        element.text().set(value.get_ref<const std::string&>().c_str());
    }
}

/// Appends a separate Description that declares all prefixes, because the prefixes in the
/// source's packet may differ.
void append_description(pugi::xml_node rdf, const std::string& about, const json& claim) {
    pugi::xml_node description = rdf.append_child("rdf:Description");
    const auto declare = [&](const char* prefix, std::string_view space) {
        description.append_attribute(prefix) = std::string(space).c_str();
    };
    declare("xmlns:rdf", xmp::rdf);
    declare("xmlns:xmp", xmp::basic);
    declare("xmlns:Iptc4xmpExt", xmp::iptc);
    declare("xmlns:item3d", xmp::item3d);
    description.append_attribute("rdf:about") = about.c_str();
    for (const PacketProperty& property : properties_of(claim)) {
        if (property.value.empty()) continue;
        const std::string name = std::string(property.prefix) + ":" + std::string(property.name);
        description.append_child(name.c_str()).text().set(property.value.c_str());
    }
    write_value(description.append_child("item3d:claim"), claim);
}

void make_empty(XmpDocument& document) {
    document.xml.reset();
    pugi::xml_node root = document.xml.append_child("x:xmpmeta");
    root.append_attribute("xmlns:x") = std::string(xmp::meta).c_str();
    document.rdf = root.append_child("rdf:RDF");
    document.rdf.append_attribute("xmlns:rdf") = std::string(xmp::rdf).c_str();
}

/// Returns the rdf:about of the source's packet. All Descriptions of one packet must have the same
/// value.
std::string about_of(const pugi::xml_node& rdf) {
    for (const pugi::xml_node description : descriptions_of(rdf))
        for (const pugi::xml_attribute attribute : description.attributes())
            if (is_named(description, attribute.name(), xmp::rdf, "about"))
                return attribute.value();
    return "";
}

}  // namespace

PacketMetadata read_xmp(const std::string& packet) {
    XmpDocument document;
    parse_packet(packet, document);
    PacketMetadata metadata;
    metadata.problem = document.problem;
    if (!document.rdf) return metadata;
    metadata.claim = claim_of(document.rdf);
    metadata.source_type = text_of_property(document.rdf, xmp::iptc, "DigitalSourceType");
    metadata.creator = text_of_property(document.rdf, xmp::dublin_core, "creator");
    metadata.rights = text_of_property(document.rdf, xmp::dublin_core, "rights");
    metadata.usage_terms = text_of_property(document.rdf, xmp::rights, "UsageTerms");
    return metadata;
}

std::string xmp_with_claim(const std::string& packet, const json& claim) {
    XmpDocument document;
    if (!packet.empty()) parse_packet(packet, document);
    if (!document.rdf) make_empty(document);
    const std::string about = about_of(document.rdf);
    remove_property(document.rdf, xmp::item3d, "claim");
    for (const PacketProperty& property : properties_of(claim))
        remove_property(document.rdf, property.space, property.name);
    append_description(document.rdf, about, claim);
    std::ostringstream text;
    text << "<?xpacket begin=\"\xef\xbb\xbf\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n";
    document.xml.save(text, " ", pugi::format_indent | pugi::format_no_declaration,
                      pugi::encoding_utf8);
    text << "<?xpacket end=\"w\"?>";
    return text.str();
}

}  // namespace item3d
