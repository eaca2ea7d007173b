// The settings as JSON, in web/settings.json, for programs that show them.
#pragma once

#include <nlohmann/json.hpp>

namespace item3d {

/// Returns one object for each setting with an option, in the order of settings_table(): "name",
/// "flag", "group", "type" (text, choice, integer, number, numbers, texts or repeated_texts),
/// "default", "values" (in words) and "help". If they are known, it also has "choices", "minimum"
/// and "maximum". If the value names a file, it also has "path".
nlohmann::json settings_catalogue();

}  // namespace item3d
