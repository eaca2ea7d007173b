// Seeds as the command line has them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

/// "0..2", "3" or "0,4,7": at most 1000, each once. Throws UsageError.
std::vector<std::uint64_t> parse_seeds(const std::string& text);

}  // namespace item3d
