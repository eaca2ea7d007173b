#include "item3d/edit/metals.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace item3d {
namespace {

/// Sorted.
constexpr std::array<std::string_view, 29> metal_words = {
    "alloy",  "aluminium", "aluminum", "brass",    "bronze",   "chrome", "chromed",  "chromium",
    "cobalt", "copper",    "foil",     "gilded",   "gilt",     "gold",   "golden",   "iron",
    "metal",  "metallic",  "nickel",   "pewter",   "platinum", "silver", "silvered", "silvery",
    "steel",  "tin",       "titanium", "tungsten", "zinc"};

}  // namespace

bool names_metal(const std::string& prompt) {
    std::string word;
    // The end counts as a separator.
    for (std::size_t i = 0; i <= prompt.size(); ++i) {
        const auto byte = i < prompt.size() ? static_cast<unsigned char>(prompt[i]) : ' ';
        if (std::isalpha(byte) != 0) {
            word += static_cast<char>(std::tolower(byte));
            continue;
        }
        if (std::binary_search(metal_words.begin(), metal_words.end(), word)) return true;
        word.clear();
    }
    return false;
}

bool crosses_metallic(const std::string& from, const std::string& to) {
    return names_metal(from) != names_metal(to);
}

}  // namespace item3d
