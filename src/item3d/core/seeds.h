// Parsing of seeds on the command line.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

/// Parses a list of at most 1000 distinct seeds: "0..2", "3" or "0,4,7". Throws UsageError for an
/// empty text, for a range whose last seed is below its first, and for more than 1000 seeds.
std::vector<std::uint64_t> parse_seeds(const std::string& text);

}  // namespace item3d
