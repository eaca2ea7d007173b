#include "item3d/edit/settings_catalogue.h"

#include "item3d/core/format.h"
#include "item3d/edit/settings_table.h"

#include <algorithm>
#include <array>

namespace item3d {
namespace {

constexpr std::array settings_of_files = {"lora", "embedding", "controlnet", "vae"};

/// Rounds a float to its shortest decimal form: 0.01 instead of all digits.
nlohmann::json plain_value(nlohmann::json value) {
    if (value.is_number_float())
        return nlohmann::json::parse(fmt::format("{}", value.get<float>()));
    if (value.is_array())
        for (nlohmann::json& element : value)
            element = plain_value(element);
    return value;
}

}  // namespace

nlohmann::json settings_catalogue() {
    nlohmann::json all = nlohmann::json::array();
    for (const Setting& row : settings_table()) {
        if (row.flag.empty()) continue;
        nlohmann::json entry = {{"name", row.name},     {"flag", row.flag},
                                {"group", row.group},   {"default", plain_value(row.get({}))},
                                {"values", row.values}, {"help", row.help}};
        entry["type"] = row.choices.empty() ? type_name(row.type) : "choice";
        if (!row.choices.empty()) entry["choices"] = row.choices;
        if (row.low) entry["minimum"] = *row.low;
        if (row.high) entry["maximum"] = *row.high;
        if (std::find(settings_of_files.begin(), settings_of_files.end(), row.name) !=
            settings_of_files.end())
            entry["path"] = true;
        all.push_back(std::move(entry));
    }
    return all;
}

}  // namespace item3d
