// Static data of the page: version, prior and its words, settings, lights, this machine.
#pragma once

#include <nlohmann/json.hpp>

namespace item3d {

class Studio;

/// Returns the data. Throws InputError if the prior cannot be read.
nlohmann::json about_studio(const Studio& studio);

}  // namespace item3d
