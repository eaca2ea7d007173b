#include "apps/item3d/edit/plan_file.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/edit/settings_table.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* example =
    R"(as in {"edits": [{"from": "a cow", "to": "a golden cow", "region": ["named=black"]}]})";

/// Converts a single selector to a list of one.
json with_lists(json edit) {
    for (const char* name : {"region", "exclude"})
        if (edit.contains(name) && edit[name].is_string()) edit[name] = json::array({edit[name]});
    return edit;
}

/// Throws InputError if a value's type differs from its setting's.
void check_types(const std::string& place, const json& edit) {
    for (const auto& [name, value] : edit.items()) {
        EditSettings settings;
        try {
            setting_named(name).set(settings, value);
        } catch (const json::exception&) {
            throw InputError(
                place, fmt::format("{} cannot be {}", name, value.dump()),
                "expected a value such as " + setting_named(name).get(EditSettings()).dump());
        }
    }
}

}  // namespace

std::vector<json> read_plan_file(const fs::path& path) {
    const json document = parse_json_text(read_text(path), path.string());
    if (!document.is_object() || !document.contains("edits") || !document["edits"].is_array() ||
        document["edits"].empty())
        throw InputError(path.string(), "expected a list of edits", example);
    std::vector<json> edits;
    for (const json& given : document["edits"]) {
        const std::string place = fmt::format("{}: edit {}", path.string(), edits.size() + 1);
        if (!given.is_object()) throw InputError(place, "expected an object", example);
        const json edit = with_lists(given);
        for (const auto& [name, value] : edit.items()) {
            const auto& table = settings_table();
            if (std::none_of(table.begin(), table.end(),
                             [&, key = name](const Setting& row) { return row.name == key; }))
                throw InputError(place, "'" + name + "' is not a setting",
                                 "docs/reference/settings.md lists them");
        }
        for (const char* key : {"from", "to"})
            if (!edit.contains(key))
                throw InputError(place, fmt::format("\"{}\" is missing", key), example);
        check_types(place, edit);
        edits.push_back(edit);
    }
    return edits;
}

}  // namespace item3d
