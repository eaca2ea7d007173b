// Options of `item3d edit` with the values that cases give them.
#pragma once

#include "item3d/edit/setting.h"

#include <nlohmann/json.hpp>

#include <string>

namespace item3d {

/// Returns the setting of an option without dashes ("clip-loss"); null for an option that is none.
const Setting* setting_of_option(const std::string& option);

/// Returns a value with the setting's type, as the command line reads its text: "100" is 100, and
/// "a,b" a list. Throws InputError with `subject`.
nlohmann::json typed_value(const Setting& setting, const nlohmann::json& value,
                           const std::string& subject);

/// Throws InputError with `subject` for a value that `item3d edit` refuses whatever else is given:
/// type, range, choice, kind of selector; a light, a file of a LoRA or an embedding, or a folder of
/// networks or textures, that does not exist.
void check_option(const std::string& option, const nlohmann::json& value,
                  const std::string& subject);

}  // namespace item3d
