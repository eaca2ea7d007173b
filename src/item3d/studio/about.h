// Static data of the page: the version, the prior and its words, the settings, the lights, and
// facts of this machine.
#pragma once

#include <nlohmann/json.hpp>

namespace item3d {

class Studio;

/// Returns the data. Throws InputError if the prior cannot be read.
nlohmann::json about_studio(const Studio& studio);

}  // namespace item3d
