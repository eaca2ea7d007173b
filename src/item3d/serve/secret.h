// Random names that nobody can guess, and their comparison.
#pragma once

#include <string>

namespace item3d {

/// Hexadecimal digits of `bytes` random bytes (at most 64) of the system. Throws ResourceError
/// where the system gives none.
std::string random_secret(int bytes);

/// Whether both are equal; takes as long for each text of one length.
bool equals_secret(const std::string& given, const std::string& secret);

}  // namespace item3d
