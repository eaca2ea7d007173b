#include "item3d/provenance/claim.h"

#include "item3d/core/version.h"

#include <algorithm>
#include <utility>

namespace item3d {
namespace {

using nlohmann::json;

constexpr std::pair<const char*, std::string EditClaim::*> edit_members[] = {
    {"from", &EditClaim::from},
    {"to", &EditClaim::to},
    {"method", &EditClaim::method},
    {"prior", &EditClaim::prior},
    {"prior_hash", &EditClaim::prior_hash},
    {"input", &EditClaim::input},
    {"input_sha256", &EditClaim::input_sha256},
    {"date", &EditClaim::date},
    {"version", &EditClaim::version},
    {"strength", &EditClaim::strength},
    {"variant", &EditClaim::variant},
    {"photographs", &EditClaim::photographs},
    {"source_type", &EditClaim::source_type},
};

constexpr std::pair<const char*, std::string ImageClaim::*> image_members[] = {
    {"image", &ImageClaim::image}, {"name", &ImageClaim::name}, {"sha256", &ImageClaim::sha256}};

std::string replace_invalid_utf8(const std::string& text) {
    const std::string dumped = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
    return json::parse(dumped).get<std::string>();
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

/// Returns text that XML 1.0 can hold, without line ends, which XML parsers normalise.
std::string plain_text(const std::string& text) {
    std::string plain = replace_invalid_utf8(text);
    for (char& c : plain)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    for (const char* noncharacter : {"\xef\xbf\xbe", "\xef\xbf\xbf"})
        replace_all(plain, noncharacter, "\xef\xbf\xbd");
    const auto begin = plain.find_first_not_of(' ');
    if (begin == std::string::npos) return "";
    return plain.substr(begin, plain.find_last_not_of(' ') + 1 - begin);
}

template <typename T, typename Members>
void write_members(json& out, const T& value, const Members& members) {
    out = json::object();
    for (const auto& [key, member] : members)
        if (const std::string text = plain_text(value.*member); !text.empty()) out[key] = text;
}

template <typename T, typename Members>
void read_members(const json& in, T& value, const Members& members) {
    if (!in.is_object()) return;
    for (const auto& [key, member] : members)
        if (const auto found = in.find(key); found != in.end() && found->is_string())
            value.*member = found->template get<std::string>();
}

template <typename T>
std::vector<T> list_of(const json& claim, const char* key) {
    if (!claim.is_object()) return {};
    const auto found = claim.find(key);
    if (found == claim.end() || !found->is_array()) return {};
    return found->get<std::vector<T>>();
}

}  // namespace

bool is_reconstruction(const EditClaim& edit) {
    return !edit.photographs.empty();
}

void to_json(json& out, const EditClaim& edit) {
    write_members(out, edit, edit_members);
}

void from_json(const json& in, EditClaim& edit) {
    read_members(in, edit, edit_members);
}

void to_json(json& out, const ImageClaim& image) {
    write_members(out, image, image_members);
}

void from_json(const json& in, ImageClaim& image) {
    read_members(in, image, image_members);
}

json make_claim(const std::vector<EditClaim>& edits, const std::vector<ImageClaim>& images,
                const std::string& document_sha256) {
    json claim{{"program", "item3d"}, {"version", version()}, {"edits", edits}};
    if (!images.empty()) claim["images"] = images;
    if (!document_sha256.empty()) claim["document_sha256"] = document_sha256;
    return claim;
}

std::vector<EditClaim> edits_of(const json& claim) {
    return list_of<EditClaim>(claim, "edits");
}

std::vector<ImageClaim> images_of(const json& claim) {
    return list_of<ImageClaim>(claim, "images");
}

std::vector<EditClaim> join_edits(std::vector<EditClaim> earlier,
                                  const std::vector<EditClaim>& now) {
    for (const EditClaim& edit : now) {
        // Edits are compared in the form that is read back, because writing may replace invalid
        // text.
        const EditClaim plain = json(edit).get<EditClaim>();
        if (std::find(earlier.begin(), earlier.end(), plain) == earlier.end())
            earlier.push_back(plain);
    }
    return earlier;
}

std::string date_of(const std::vector<EditClaim>& edits) {
    std::string latest;
    for (const EditClaim& edit : edits)
        latest = std::max(latest, edit.date);
    return latest;
}

std::string canonical_claim(json claim) {
    claim.erase("signature");
    // The shortest form is the canonical one: keys are ASCII and sorted, and all values are
    // strings.
    return claim.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace item3d
