// JSON from text, with errors for people.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace item3d {

/// Throws InputError that begins with `subject`, names the line and says what to look for.
nlohmann::json parse_json_text(const std::string& text, const std::string& subject);

}  // namespace item3d
