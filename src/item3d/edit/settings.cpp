#include "item3d/edit/settings.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/edit/settings_table.h"

#include <algorithm>

namespace item3d {
namespace {

using nlohmann::json;

/// Returns a type's name for messages: "repeated texts".
std::string type_words(SettingType type) {
    std::string name = type_name(type);
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

}  // namespace

void to_json(json& json, const EditSettings& settings) {
    json = nlohmann::json::object();
    for (const Setting& row : settings_table())
        json[row.name] = row.get(settings);
}

void from_json(const json& json, EditSettings& settings) {
    settings = {};
    for (const Setting& row : settings_table())
        if (json.contains(row.name)) row.set(settings, json.at(row.name));
}

void check_settings(const EditSettings& settings) {
    for (const Setting& row : settings_table())
        row.check(settings);
}

std::string readable(const json& value) {
    if (value.is_number_float()) return fmt::format("{}", value.get<float>());
    if (value.is_array()) {
        std::string list;
        for (const json& each : value)
            list += (list.empty() ? "" : ", ") + readable(each);
        return list.empty() ? "none" : list;
    }
    if (!value.is_string()) return value.dump();
    return value.get<std::string>().empty() ? "none" : value.get<std::string>();
}

std::string settings_markdown() {
    std::string text =
        "# Settings of an edit\n\n"
        "<!-- Written from src/item3d/edit/settings_table.cpp by a test:\n"
        "     ITEM3D_WRITE_DOCS=1 build/test_edit --gtest_filter='*SettingsPage*' -->\n\n"
        "Everything that changes the result of `item3d edit`. A prior brings values of its own in\n"
        "`prior.json` under `\"defaults\"`, options override these, and `edit.json` lists what an "
        "edit\nwas done with under `\"settings\"`. Settings without an option are a prior's to "
        "say.\n\n"
        "| Setting | Option | Default | Values | Meaning |\n|---|---|---|---|---|\n";
    for (const Setting& row : settings_table()) {
        const std::string value = readable(row.get({}));
        text += fmt::format("| `{}` | {} | {} | {}{} | {} |\n", row.name,
                            row.flag.empty() ? "" : "`" + row.flag + "`",
                            value == "none" ? "" : "`" + value + "`", type_words(row.type),
                            row.values.empty() ? "" : ": " + row.values, row.help);
    }
    return text;
}

}  // namespace item3d
