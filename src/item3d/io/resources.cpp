#include "item3d/io/resources.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/find_file.h"
#include "item3d/io/text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <optional>

namespace item3d {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view base64_digits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

Bytes decode_base64(std::string_view text, const std::string& subject) {
    std::array<std::int8_t, 256> values;
    values.fill(-1);
    for (int i = 0; i < 64; ++i) {
        values[static_cast<unsigned char>(base64_digits[i])] = static_cast<std::int8_t>(i);
    }
    values['-'] = 62;  // URL-safe alphabet, which some writers use
    values['_'] = 63;
    while (!text.empty() && text.back() == '=')
        text.remove_suffix(1);
    Bytes bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        if (c == '\n' || c == '\r' || c == ' ') continue;
        const int value = values[static_cast<unsigned char>(c)];
        if (value < 0) {
            throw InputError(subject, "a data URI contains bytes that are not base64",
                             "export it again");
        }
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes.push_back(static_cast<std::uint8_t>(bits >> count & 255));
        }
    }
    return bytes;
}

/// Returns the advice for a missing file. It mentions --textures only for images, because only
/// images are also searched for in other folders.
std::string cure_of(std::string_view name) {
    const std::string cure = "copy that file next to the model";
    const std::string extension = to_lower(fs::path(name).extension().string());
    return extension == ".bin" || extension == ".mtl"
               ? cure
               : cure + ", or give its folder with --textures";
}

}  // namespace

fs::path resolve_in_folder(const fs::path& folder, const fs::path& relative,
                           const std::string& subject, Forgiving forgiving) {
    const std::string name = relative.string();
    if (name.empty() || name.find('\0') != std::string::npos) {
        throw InputError(subject, "refers to a file without a name", "export the file again");
    }
    std::error_code code;
    const fs::path root = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, code);
    const fs::path target = code ? fs::path() : fs::weakly_canonical(root / relative, code);
    const fs::path inside = target.lexically_relative(root);
    const bool is_outside =
        code || relative.is_absolute() || inside.empty() || *inside.begin() == "..";
    const fs::file_status status = fs::status(target, code);
    if (!is_outside && fs::is_regular_file(status)) return target;
    if (is_outside || !fs::exists(status)) {
        for (const std::string& spelling : other_spellings(name)) {
            const auto found = find_file_below(root, spelling);
            if (!found) continue;
            if (forgiving == Forgiving::with_note) {
                note(subject + ": refers to '" + to_utf8(name) + "', read as '" +
                     to_utf8(found->lexically_relative(root).generic_string()) + "'");
            }
            return *found;
        }
    }
    if (is_outside) {
        throw InputError(subject, "refers to '" + to_utf8(name) + "', which is outside its folder",
                         cure_of(name));
    }
    throw InputError(subject,
                     "refers to '" + to_utf8(name) + "', which " +
                         (fs::exists(status) ? "is not a file" : "does not exist"),
                     cure_of(name));
}

fs::path resolve_uri(const fs::path& folder, std::string_view uri, const std::string& subject,
                     Forgiving forgiving) {
    const std::size_t colon = uri.find(':');
    const bool has_scheme = colon != std::string_view::npos && uri.find('/') > colon;
    const bool is_local = colon == 1 || to_lower(uri.substr(0, 5)) == "file:";
    if (has_scheme && !is_local) {
        throw InputError(subject,
                         "refers to '" + to_utf8(uri.substr(0, 80)) +
                             "', but files are only read from its folder",
                         cure_of(uri));
    }
    // The percent-decoded name is tried first. If no such file exists, the undecoded name and its
    // other spellings are tried.
    std::error_code code;
    const std::string decoded = percent_decode(uri);
    if (!fs::is_regular_file((folder.empty() ? fs::path(".") : folder) / decoded, code))
        return resolve_in_folder(folder, std::string(uri), subject, forgiving);
    return resolve_in_folder(folder, decoded, subject, forgiving);
}

fs::path resolve_beside(const fs::path& root, const std::vector<fs::path>& folders,
                        const std::string& name, const std::string& subject,
                        const std::vector<fs::path>& allowed) {
    std::string slashed = name;
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    const fs::path relative = slashed;
    const fs::path bare = relative.filename();
    std::error_code code;
    const fs::path top = fs::weakly_canonical(root.empty() ? fs::path(".") : root, code);
    if (bare.empty())
        throw InputError(subject, "refers to a file without a name", "export the file again");
    std::optional<InputError> first;
    for (const fs::path& wanted : {relative, bare}) {
        for (const fs::path& folder : folders) {
            const fs::path from =
                fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, code)
                    .lexically_relative(top);
            try {
                return resolve_in_folder(root, (from / wanted).lexically_normal(), subject);
            } catch (const InputError& error) {
                if (!first) first = error;
            }
        }
    }
    for (const fs::path& folder : folders) {
        if (const auto found = find_allowed(allowed, folder, relative, subject)) return *found;
    }
    throw *first;
}

namespace {

constexpr std::size_t max_folders = 1000;
constexpr int deepest_folder = 4;

/// Returns the folders below `root` from which images may be read, relative to it, sorted by name.
std::vector<fs::path> folders_below(const fs::path& root) {
    std::vector<fs::path> folders;
    std::error_code code;
    for (fs::recursive_directory_iterator entry(root, code), end; !code && entry != end;
         entry.increment(code)) {
        if (entry.depth() >= deepest_folder) entry.disable_recursion_pending();
        if (entry->is_directory(code)) folders.push_back(entry->path().lexically_relative(root));
        if (folders.size() >= max_folders) break;
    }
    std::sort(folders.begin(), folders.end());
    return folders;
}

}  // namespace

std::optional<fs::path> find_allowed(const std::vector<fs::path>& allowed, const fs::path& folder,
                                     const fs::path& name, const std::string& subject) {
    std::error_code code;
    const fs::path target =
        fs::weakly_canonical((folder.empty() ? fs::path(".") : folder) / name, code);
    for (const fs::path& root : allowed) {
        std::vector<fs::path> tries{target.lexically_relative(fs::weakly_canonical(root, code))};
        // The last candidates are files with the bare name in subfolders.
        const auto below = folders_below(root);
        for (auto from = name.begin(); from != name.end(); ++from) {
            fs::path end;
            for (auto part = from; part != name.end(); ++part)
                end /= *part;
            tries.push_back(end);
        }
        for (const fs::path& path : below)
            tries.push_back(path / name.filename());
        for (const fs::path& wanted : tries) {
            if (wanted.empty() || wanted.is_absolute() || *wanted.begin() == "..") continue;
            if (!fs::is_regular_file(root / wanted, code)) continue;
            try {
                return resolve_in_folder(root, wanted, subject);
            } catch (const InputError&) {
                // The path is a link to the outside.
            }
        }
    }
    return std::nullopt;
}

bool is_data_uri(std::string_view uri) {
    return to_lower(uri.substr(0, 5)) == "data:";
}

Bytes decode_data_uri(std::string_view uri, const std::string& subject) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string_view::npos) {
        throw InputError(subject, "a data URI has no comma", "export it again");
    }
    const std::string_view kind = uri.substr(0, comma);
    const std::string_view data = uri.substr(comma + 1);
    if (to_lower(kind).ends_with(";base64")) {
        if (data.find('%') == std::string_view::npos) return decode_base64(data, subject);
        return decode_base64(percent_decode(data), subject);
    }
    const std::string text = percent_decode(data);
    return Bytes(text.begin(), text.end());
}

std::string path_to_uri(const fs::path& relative) {
    constexpr std::string_view plain = "-._~/!$&'()*+,;=@";
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string result;
    for (const char c : relative.generic_string()) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80 && (std::isalnum(byte) || plain.find(c) != std::string_view::npos)) {
            result.push_back(c);
        } else {
            result.push_back('%');
            result.push_back(digits[byte >> 4]);
            result.push_back(digits[byte & 15]);
        }
    }
    return result;
}

std::string encode_base64(std::span<const std::uint8_t> bytes) {
    std::string result;
    result.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (k < count ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k) {
            result.push_back(k <= count ? base64_digits[bits >> (18 - 6 * k) & 63] : '=');
        }
    }
    return result;
}

}  // namespace item3d
