#include "item3d/edit/settings.h"

#include "item3d/edit/settings_table.h"

namespace item3d {

void to_json(nlohmann::json& json, const EditSettings& settings) {
    json = nlohmann::json::object();
    for (const Setting& setting : settings_table())
        json[setting.name] = setting.get(settings);
}

void from_json(const nlohmann::json& json, EditSettings& settings) {
    settings = {};
    for (const Setting& setting : settings_table())
        if (json.contains(setting.name)) setting.set(settings, json.at(setting.name));
}

void check_settings(const EditSettings& settings) {
    for (const Setting& setting : settings_table())
        setting.check(settings);
}

}  // namespace item3d
