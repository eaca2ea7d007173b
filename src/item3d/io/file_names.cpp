#include "item3d/io/file_names.h"

#include "item3d/io/text.h"

#include <cctype>

namespace item3d {

std::string shortened(const std::string& name, std::size_t longest) {
    if (name.size() <= longest) return name;
    while (longest > 0 && (static_cast<unsigned char>(name[longest]) & 0xc0) == 0x80)
        --longest;
    return name.substr(0, longest);
}

std::string plain_file_name(const std::string& name) {
    std::string result;
    for (const char c : name.substr(0, 80)) {
        const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_';
        result.push_back(is_plain ? c : '_');
    }
    return result;
}

std::string FileNames::unused(const std::string& name) {
    for (int attempt = 0;; ++attempt) {
        const std::string candidate = attempt == 0 ? name : name + "_" + std::to_string(attempt);
        if (used_.insert(to_lower(candidate)).second) return candidate;
    }
}

}  // namespace item3d
