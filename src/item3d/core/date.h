// The date of today, as reproducible builds want it.
#pragma once

#include <string>

namespace item3d {

/// UTC, "2026-11-27T15:04:05Z": the seconds since 1970 in the environment's SOURCE_DATE_EPOCH where
/// it is set, else now. Throws InputError for a SOURCE_DATE_EPOCH that is no such number.
std::string utc_date();

}  // namespace item3d
