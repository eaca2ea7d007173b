#include "item3d/io/encoding.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/text.h"

#include <unicode/normalizer2.h>
#include <unicode/ucnv.h>
#include <unicode/unistr.h>

#include <algorithm>
#include <memory>
#include <optional>

namespace item3d {
namespace fs = std::filesystem;
namespace {

/// A legacy encoding: its name in ICU and its usual name. Multi-byte encodings come first, because
/// few texts in other encodings are valid in them.
struct OldEncoding {
    const char* converter;
    const char* shown;
};
constexpr OldEncoding old_encodings[] = {
    {"gb18030", "GBK"},
    {"ibm-943_P15A-2003", "Shift_JIS"},
    {"windows-950", "Big5"},
    {"windows-949", "EUC-KR"},
    {"euc-jp", "EUC-JP"},
    {"windows-1252", "Latin-1"},
    {"windows-1250", "Windows-1250"},
    {"windows-1251", "Windows-1251"},
    {"windows-1253", "Windows-1253"},
    {"windows-1254", "Windows-1254"},
    {"koi8-r", "KOI8-R"},
    {"ibm-850", "code page 850"},
    {"ibm-437", "code page 437"},
    {"macintosh", "Mac Roman"},
};

bool is_ascii(std::string_view text) {
    return std::all_of(text.begin(), text.end(),
                       [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

/// Converts a text to Unicode. Returns no value if it is not in that encoding, or if ICU lacks the
/// encoding.
std::optional<icu::UnicodeString> convert(std::string_view text, const char* converter) {
    if (text.size() >= 1u << 30) return std::nullopt;  // ICU's sizes have 32 bits
    UErrorCode status = U_ZERO_ERROR;
    const std::unique_ptr<UConverter, decltype(&ucnv_close)> open(ucnv_open(converter, &status),
                                                                  &ucnv_close);
    if (U_FAILURE(status)) return std::nullopt;
    ucnv_setToUCallBack(open.get(), UCNV_TO_U_CALLBACK_STOP, nullptr, nullptr, nullptr, &status);
    icu::UnicodeString result(text.data(), static_cast<std::int32_t>(text.size()), open.get(),
                              status);
    if (U_FAILURE(status) || result.isBogus()) return std::nullopt;
    return result;
}

icu::UnicodeString composed(const icu::UnicodeString& text) {
    UErrorCode status = U_ZERO_ERROR;
    const icu::Normalizer2* nfc = icu::Normalizer2::getNFCInstance(status);
    return U_FAILURE(status) ? text : nfc->normalize(text, status);
}

std::string utf8_of(const icu::UnicodeString& text) {
    std::string result;
    text.toUTF8String(result);
    return result;
}

/// Returns the name of a wide encoding ("UTF-16LE"), detected by a byte order mark or by the
/// position of zero bytes in the first characters; null for other texts.
const char* wide_encoding(std::string_view text) {
    using namespace std::string_view_literals;
    if (text.starts_with("\xff\xfe\0\0"sv)) return "UTF-32LE";
    if (text.starts_with("\0\0\xfe\xff"sv)) return "UTF-32BE";
    if (text.starts_with("\xff\xfe"sv)) return "UTF-16LE";
    if (text.starts_with("\xfe\xff"sv)) return "UTF-16BE";
    const std::string_view head = text.substr(0, 64);
    if (head.size() < 8) return nullptr;
    std::size_t zeros[2] = {0, 0};
    for (std::size_t i = 0; i < head.size() / 2 * 2; ++i)
        zeros[i % 2] += head[i] == '\0';
    if (zeros[0] == 0 && zeros[1] > head.size() / 4) return "UTF-16LE";
    if (zeros[1] == 0 && zeros[0] > head.size() / 4) return "UTF-16BE";
    return nullptr;
}

/// True if only lines that begin with "#" are not UTF-8.
bool is_utf8_but_for_remarks(std::string_view text) {
    while (!text.empty()) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size() - 1) + 1;
        const std::string_view line = trim(text.substr(0, end));
        if (!line.starts_with('#') && !is_utf8(line)) return false;
        text.remove_prefix(end);
    }
    return true;
}

}  // namespace

bool is_utf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        const auto first = static_cast<unsigned char>(text[i]);
        const std::size_t length = first < 0x80                    ? 1
                                   : first >= 0xc2 && first < 0xe0 ? 2
                                   : first >= 0xe0 && first < 0xf0 ? 3
                                   : first >= 0xf0 && first < 0xf5 ? 4
                                                                   : 0;
        if (length == 0 || length > text.size() - i) return false;
        for (std::size_t k = 1; k < length; ++k) {
            if ((static_cast<unsigned char>(text[i + k]) & 0xc0) != 0x80) return false;
        }
        const auto second = length > 1 ? static_cast<unsigned char>(text[i + 1]) : 0;
        // UTF-8 forbids overlong forms, surrogates, and code points beyond U+10FFFF.
        if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
            (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) {
            return false;
        }
        i += length;
    }
    return true;
}

std::string decode_text(std::string_view bytes, const std::vector<std::string>& names,
                        const std::string& subject) {
    if (const char* wide = wide_encoding(bytes)) {
        auto text = convert(bytes, wide);
        if (!text) {
            throw InputError(subject, std::string("looks like ") + wide + " but is not valid",
                             "save it as UTF-8");
        }
        if (text->startsWith(static_cast<char16_t>(0xfeff))) text->remove(0, 1);
        return utf8_of(*text);
    }
    if (is_utf8(bytes)) return std::string(bytes);
    if (is_utf8_but_for_remarks(bytes)) return to_utf8(bytes);

    std::vector<icu::UnicodeString> wanted;
    for (const std::string& name : names) {
        if (is_ascii(name)) continue;
        if (!is_utf8(name)) {
            if (bytes.find(name) != std::string_view::npos) return std::string(bytes);
            continue;
        }
        wanted.push_back(composed(icu::UnicodeString::fromUTF8(name)));
    }
    for (const OldEncoding& encoding : old_encodings) {
        if (wanted.empty()) break;
        const auto text = convert(bytes, encoding.converter);
        if (!text) continue;
        const icu::UnicodeString whole = composed(*text);
        const bool holds_one =
            std::any_of(wanted.begin(), wanted.end(),
                        [&](const icu::UnicodeString& name) { return whole.indexOf(name) >= 0; });
        if (!holds_one) continue;
        note(subject + ": is not UTF-8; read as " + encoding.shown);
        return utf8_of(*text);
    }
    note(subject + ": is not UTF-8 and no file has a name in it; read as Latin-1");
    return to_utf8(bytes);
}

std::vector<std::string> names_below(const fs::path& folder) {
    constexpr std::size_t max_names = 5000;
    std::vector<std::string> names;
    std::error_code code;
    const fs::path root = folder.empty() ? fs::path(".") : folder;
    for (fs::recursive_directory_iterator
             i(root, fs::directory_options::skip_permission_denied, code),
         end;
         !code && i != end && names.size() < max_names; i.increment(code)) {
        if (i.depth() >= 3) i.disable_recursion_pending();
        names.push_back(i->path().filename().string());
    }
    return names;
}

}  // namespace item3d
