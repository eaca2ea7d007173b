#include "item3d/study/study.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/random.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <set>
#include <stdexcept>

namespace item3d {
namespace {

constexpr const char* make_hint = "create a study with `item3d study make`";
constexpr std::array kind_names = {"practice", "rating", "attention"};

nlohmann::json item_json(const StudyItem& item) {
    return {{"id", item.id},
            {"kind", kind_name(item.kind)},
            {"case", item.case_name},
            {"method", item.method},
            {"from", item.from},
            {"to", item.to},
            {"note", item.note},
            {"before", item.before},
            {"after", item.after},
            {"turntable", item.turntable},
            {"expected", item.expected},
            {"scores", item.scores}};
}

StudyItemKind read_kind(const std::string& name) {
    for (std::size_t i = 0; i < kind_names.size(); ++i)
        if (name == kind_names[i]) return static_cast<StudyItemKind>(i);
    throw std::out_of_range("unknown kind of item '" + name + "'");
}

/// Reads a plain file name without a path.
std::string read_name(const nlohmann::json& name) {
    const auto text = name.get<std::string>();
    if (text.find('/') != std::string::npos || text == "..")
        throw std::out_of_range("'" + text + "' is not the name of an image");
    return text;
}

StudyItem read_item(const nlohmann::json& json) {
    StudyItem item;
    item.id = json.at("id").get<std::string>();
    item.kind = read_kind(json.at("kind").get<std::string>());
    item.case_name = json.at("case").get<std::string>();
    item.method = json.at("method").get<std::string>();
    item.from = json.at("from").get<std::string>();
    item.to = json.at("to").get<std::string>();
    item.note = json.at("note").get<std::string>();
    item.before = read_name(json.at("before"));
    item.after = read_name(json.at("after"));
    item.turntable = read_name(json.at("turntable"));
    for (std::size_t i = 0; i < item.expected.size(); ++i)
        item.expected[i] = static_cast<int>(integer_of(json.at("expected").at(i), 0, max_rating));
    item.scores = json.at("scores").get<std::map<std::string, double>>();
    return item;
}

nlohmann::json study_json(const Study& study) {
    nlohmann::json items = nlohmann::json::array();
    for (const StudyItem& item : study.items)
        items.push_back(item_json(item));
    return {{"format", "item3d study"}, {"version", 1},
            {"title", study.title},     {"seed", study.seed},
            {"methods", study.methods}, {"items", items},
            {"consent", study.consent}};
}

void check_items(const Study& study) {
    std::set<std::string> ids;
    for (const StudyItem& item : study.items) {
        if (!ids.insert(item.id).second)
            throw std::out_of_range("two items have the id '" + item.id + "'");
    }
}

void check_image(const std::filesystem::path& path) {
    std::error_code code;
    const auto size = std::filesystem::file_size(path, code);
    if (code || size == 0)
        throw InputError(path.string(), code ? "cannot be found" : "is empty",
                         "restore it, or make the study again in another folder");
}

}  // namespace

std::string_view kind_name(StudyItemKind kind) {
    return kind_names[static_cast<std::size_t>(kind)];
}

const StudyItem& Study::item(const std::string& id) const {
    for (const StudyItem& item : items)
        if (item.id == id) return item;
    throw std::out_of_range("no item " + id);
}

std::string Study::fingerprint() const {
    std::uint64_t bits = 0;
    for (const char character : study_json(*this).dump())
        bits = mix_bits(bits ^ static_cast<unsigned char>(character));
    return fmt::format("{:016x}", bits);
}

void write_study(const Study& study, const std::filesystem::path& folder) {
    write_atomically(folder / "study.json", study_json(study).dump(2) + "\n");
}

void check_study_images(const Study& study, const std::filesystem::path& folder) {
    for (const StudyItem& item : study.items)
        for (const std::string& name : {item.before, item.after, item.turntable})
            if (!name.empty()) check_image(folder / "pictures" / name);
}

Study read_study(const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / "study.json";
    if (!std::filesystem::exists(path) && std::filesystem::exists(folder / "table.csv"))
        throw InputError(
            folder.string(), "is a comparison, not a study",
            fmt::format("make a study of it: item3d study make {} -o STUDY", folder.string()));
    const nlohmann::json json = parse_json_text(read_text(path), path.string());
    try {
        if (json.at("format") != "item3d study" || json.at("version") != 1)
            throw std::out_of_range("it has another format");
        Study study;
        if (!json.at("seed").is_number_unsigned())
            throw std::out_of_range("its seed is not a whole number");
        study.seed = json.at("seed").get<std::uint64_t>();
        study.title = json.at("title").get<std::string>();
        study.consent = json.at("consent").get<std::string>();
        study.methods = json.at("methods").get<std::vector<std::string>>();
        for (const nlohmann::json& item : json.at("items"))
            study.items.push_back(read_item(item));
        check_items(study);
        return study;
    } catch (const Error&) {
        throw;
    } catch (const nlohmann::json::exception&) {
        throw InputError(path.string(), "is not a study: an entry is missing or of another type",
                         make_hint);
    } catch (const std::exception& error) {
        throw InputError(path.string(), std::string("is not a study: ") + error.what(), make_hint);
    }
}

}  // namespace item3d
