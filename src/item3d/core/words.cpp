#include "item3d/core/words.h"

#include <cctype>

namespace item3d {

std::vector<std::string> prompt_words(const std::string& prompt) {
    std::vector<std::string> words;
    int before = 0;  // 0: between words, 1: in letters, 2: in digits
    for (const char character : prompt) {
        const auto byte = static_cast<unsigned char>(character);
        // Bytes of other scripts count as letters, so that words in these scripts are found, as
        // unknown words.
        const int now = std::isdigit(byte) ? 2 : std::isalpha(byte) || byte >= 0x80 ? 1 : 0;
        if (now != 0 && now != before) words.emplace_back();
        if (now != 0) words.back() += static_cast<char>(std::tolower(byte));
        before = now;
    }
    return words;
}

}  // namespace item3d
