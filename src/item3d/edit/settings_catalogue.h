// The settings as JSON for programs that show them: web/settings.json.
#pragma once

#include <nlohmann/json.hpp>

namespace item3d {

/// Returns one object for each setting with an option, in the order of settings_table(): "name",
/// "flag", "group", "type" (text, choice, integer, number, numbers, texts or repeated_texts),
/// "default", "values" (in words), "help"; where known "choices", "minimum", "maximum"; "path"
/// where the value names a file.
nlohmann::json settings_catalogue();

}  // namespace item3d
