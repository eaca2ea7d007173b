#include "item3d/io/find_file.h"

#include "item3d/io/text.h"

#include <unicode/normalizer2.h>
#include <unicode/unistr.h>

#include <algorithm>
#include <cctype>

namespace item3d {
namespace fs = std::filesystem;
namespace {

int hexadecimal_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    const int lower = std::tolower(static_cast<unsigned char>(c));
    return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

// Returns a key that is equal for names that differ in case or normalization.
std::string folded(std::string_view name) {
    UErrorCode status = U_ZERO_ERROR;
    const icu::Normalizer2* normalizer = icu::Normalizer2::getNFKCCasefoldInstance(status);
    const icu::UnicodeString text = icu::UnicodeString::fromUTF8(to_utf8(name));
    std::string result;
    if (normalizer) {
        const icu::UnicodeString same = normalizer->normalize(text, status);
        if (U_SUCCESS(status)) same.toUTF8String(result);
    }
    return U_SUCCESS(status) ? result : to_lower(name);
}

// Returns the folder's entry with exactly that name, or else the first entry with an equal folded()
// name.
std::optional<fs::path> entry_of(const fs::path& folder, const std::string& name) {
    std::error_code code;
    if (fs::exists(folder / name, code)) return folder / name;
    const std::string wanted = folded(name);
    std::optional<fs::path> best;
    for (fs::directory_iterator entry(folder, code), end; !code && entry != end;
         entry.increment(code)) {
        const fs::path& path = entry->path();
        if (folded(path.filename().string()) == wanted && (!best || path < *best)) best = path;
    }
    return best;
}

std::string last_part(const std::string& name) {
    const std::size_t separator = name.find_last_of("/\\");
    return separator == std::string::npos ? name : name.substr(separator + 1);
}

}  // namespace

std::string percent_decode(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '%' && i + 2 < text.size() && hexadecimal_digit(text[i + 1]) >= 0 &&
            hexadecimal_digit(text[i + 2]) >= 0) {
            result.push_back(static_cast<char>(hexadecimal_digit(text[i + 1]) * 16 +
                                               hexadecimal_digit(text[i + 2])));
            i += 2;
        } else {
            result.push_back(text[i]);
        }
    }
    return result;
}

std::vector<std::string> other_spellings(const std::string& name) {
    std::vector<std::string> spellings;
    const auto add = [&](const std::string& spelling) {
        if (!spelling.empty() &&
            std::find(spellings.begin(), spellings.end(), spelling) == spellings.end())
            spellings.push_back(spelling);
    };
    for (const std::string& whole : {name, name.substr(0, name.find_first_of("?#"))}) {
        add(whole);
        add(percent_decode(whole));
        add(percent_decode(percent_decode(whole)));
    }
    for (const std::string& spelling : std::vector<std::string>(spellings))
        add(last_part(spelling));
    return spellings;
}

std::optional<fs::path> find_file_below(const fs::path& root, std::string_view name) {
    if (name.find('\0') != std::string_view::npos || name.starts_with('/')) return std::nullopt;
    fs::path path = root;
    while (!name.empty()) {
        const std::size_t end = std::min(name.find_first_of("/\\"), name.size());
        const std::string part(name.substr(0, end));
        name.remove_prefix(std::min(end + 1, name.size()));
        if (part.empty() || part == ".") continue;
        if (part == "..") return std::nullopt;
        const auto entry = entry_of(path, part);
        if (!entry) return std::nullopt;
        path = *entry;
    }
    std::error_code code;
    const fs::path target = fs::weakly_canonical(path, code);
    if (code || !fs::is_regular_file(target, code)) return std::nullopt;
    const fs::path inside = target.lexically_relative(fs::weakly_canonical(root, code));
    if (code || inside.empty() || *inside.begin() == "..") return std::nullopt;
    return target;
}

}  // namespace item3d
