// The current date, with support for reproducible builds.
#pragma once

#include <string>

namespace item3d {

/// Returns UTC, "2026-11-27T15:04:05Z": from the seconds since 1970 in the environment's
/// SOURCE_DATE_EPOCH if set, else the present. Throws InputError for an invalid SOURCE_DATE_EPOCH.
std::string utc_date();

}  // namespace item3d
