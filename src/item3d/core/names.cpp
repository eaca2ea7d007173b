#include "item3d/core/names.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace item3d {
namespace {

/// Returns the Levenshtein distance of two words.
std::size_t distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t corner = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = corner + (a[i - 1] == b[j - 1] ? 0 : 1);
            corner = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
        }
    }
    return row.back();
}

}  // namespace

std::string slug(const std::string& text) {
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte))
            result += static_cast<char>(std::tolower(byte));
        else if (!result.empty() && result.back() != '-')
            result += '-';
    }
    result = result.substr(0, 40);
    while (!result.empty() && result.back() == '-')
        result.pop_back();
    return result.empty() ? "case" : result;
}

std::string counted(std::size_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string nearest_name(const std::string& name, const std::vector<std::string>& known) {
    return *std::min_element(known.begin(), known.end(),
                             [&](const std::string& a, const std::string& b) {
                                 return distance(name, a) < distance(name, b);
                             });
}

std::string similar_name(const std::string& name, const std::vector<std::string>& known) {
    if (known.empty()) return "";
    const std::string nearest = nearest_name(name, known);
    const std::size_t apart = distance(name, nearest);
    const bool similar = apart <= std::max<std::size_t>(2, name.size() / 3) && apart < name.size();
    return similar ? nearest : "";
}

}  // namespace item3d
