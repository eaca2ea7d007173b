// What the page is told once: version, prior and its words, settings, lights, this machine.
#pragma once

#include <nlohmann/json.hpp>

namespace item3d {

class Studio;

/// Throws InputError where the prior cannot be read.
nlohmann::json about_studio(const Studio& studio);

}  // namespace item3d
