// The current date, with support for reproducible builds.
#pragma once

#include <string>

namespace item3d {

/// Returns a date and time in UTC, as "2026-11-27T15:04:05Z". The time is that of the environment
/// variable SOURCE_DATE_EPOCH (seconds since 1970) if it is set, else the current time. Throws
/// InputError for an invalid SOURCE_DATE_EPOCH.
std::string utc_date();

}  // namespace item3d
