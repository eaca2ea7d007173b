// Random names that cannot be guessed, and their comparison.
#pragma once

#include <string>

namespace item3d {

/// Returns `bytes` random bytes (at most 64) of the system as hexadecimal digits. Throws
/// ResourceError if the system gives none.
std::string random_secret(int bytes);

/// Compares two texts; the time is constant for texts of equal length.
bool equals_secret(const std::string& given, const std::string& secret);

}  // namespace item3d
