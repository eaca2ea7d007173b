#include "item3d/core/seeds.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

#include <algorithm>
#include <charconv>

namespace item3d {
namespace {

std::uint64_t number_of(const std::string& text, const std::string& whole) {
    std::uint64_t value = 0;
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, value);
    if (parsed.ec != std::errc() || parsed.ptr != end)
        throw UsageError("--seeds " + whole +
                         ": expected a range such as 0..2, or numbers separated by commas");
    return value;
}

}  // namespace

std::vector<std::uint64_t> parse_seeds(const std::string& text) {
    constexpr std::uint64_t maximum = 1000;
    std::vector<std::uint64_t> seeds;
    const auto too_many = [&] {
        return UsageError(fmt::format("--seeds {}: more than {} seeds; give fewer", text, maximum));
    };
    if (text.empty())
        throw UsageError("--seeds is empty; give a range such as 0..2, or numbers with commas");
    if (const std::size_t dots = text.find(".."); dots != std::string::npos) {
        const std::uint64_t first = number_of(text.substr(0, dots), text);
        const std::uint64_t last = number_of(text.substr(dots + 2), text);
        if (last < first)
            throw UsageError(
                fmt::format("--seeds {}: the last seed is smaller than the first; write {}..{}",
                            text, last, first));
        if (last - first >= maximum) throw too_many();
        for (std::uint64_t seed = first; seed <= last; ++seed)
            seeds.push_back(seed);
        return seeds;
    }
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t comma = std::min(text.find(',', begin), text.size());
        const std::uint64_t seed = number_of(text.substr(begin, comma - begin), text);
        if (std::find(seeds.begin(), seeds.end(), seed) == seeds.end()) seeds.push_back(seed);
        begin = comma + 1;
    }
    if (seeds.size() > maximum) throw too_many();
    return seeds;
}

}  // namespace item3d
