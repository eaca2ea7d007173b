// The values that cases give to options of `item3d edit`.
#pragma once

#include "item3d/edit/setting.h"

#include <nlohmann/json.hpp>

#include <string>

namespace item3d {

/// Returns the setting of an option, which is named without leading dashes ("clip-loss"). Returns
/// null for an option that is not a setting.
const Setting* setting_of_option(const std::string& option);

/// Returns a value with the setting's type. A string is read as on the command line: "100" becomes
/// a number and "a,b" a list. Throws InputError that begins with `subject`.
nlohmann::json typed_value(const Setting& setting, const nlohmann::json& value,
                           const std::string& subject);

/// Throws InputError that begins with `subject` for a value that `item3d edit` refuses whatever the
/// other options are. Such a value has a wrong type, is out of range, is not among the choices, or
/// has an unknown kind of selector. Or it names a light, a file of a LoRA or an embedding, or a
/// folder of networks or textures, that does not exist.
void check_option(const std::string& option, const nlohmann::json& value,
                  const std::string& subject);

}  // namespace item3d
