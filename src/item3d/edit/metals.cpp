#include "item3d/edit/metals.h"

#include "item3d/core/words.h"

#include <algorithm>
#include <array>
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
    const std::vector<std::string> words = prompt_words(prompt);
    return std::any_of(words.begin(), words.end(), [](const std::string& word) {
        return std::binary_search(metal_words.begin(), metal_words.end(), word);
    });
}

bool crosses_metallic(const std::string& from, const std::string& to) {
    return names_metal(from) != names_metal(to);
}

}  // namespace item3d
