#include "item3d/models/text_normalization.h"

#include "item3d/core/error.h"

#include <unicode/normalizer2.h>
#include <unicode/uchar.h>
#include <unicode/unistr.h>

#include <unordered_map>

namespace item3d {
namespace {

bool is_letter(UChar32 c) {
    return (U_GET_GC_MASK(c) & U_GC_L_MASK) != 0;
}
bool is_number(UChar32 c) {
    return (U_GET_GC_MASK(c) & U_GC_N_MASK) != 0;
}
bool is_space(UChar32 c) {
    return u_isUWhiteSpace(c) != 0;
}

std::string to_utf8(const icu::UnicodeString& text) {
    std::string result;
    text.toUTF8String(result);
    return result;
}

/// Length of the contraction ('s, 't, 're, ...) at `at`, or 0.
int contraction_length(const icu::UnicodeString& text, int at) {
    static const char* const endings[] = {"'s", "'t", "'re", "'ve", "'m", "'ll", "'d"};
    for (const char* ending : endings) {
        const icu::UnicodeString wanted(ending, -1, US_INV);
        if (text.compare(at, wanted.length(), wanted) == 0) return wanted.length();
    }
    return 0;
}

}  // namespace

std::string normalize_for_clip(const std::string& text) {
    UErrorCode status = U_ZERO_ERROR;
    const icu::Normalizer2* nfc = icu::Normalizer2::getNFCInstance(status);
    const icu::UnicodeString composed = nfc->normalize(icu::UnicodeString::fromUTF8(text), status);
    ITEM3D_CHECK(U_SUCCESS(status), "ICU has no normalisation data");

    icu::UnicodeString result;
    bool after_space = false;
    for (int i = 0; i < composed.length(); i = composed.moveIndex32(i, 1)) {
        const UChar32 c = composed.char32At(i);
        if (is_space(c)) {
            if (!after_space) result.append(static_cast<UChar32>(' '));
            after_space = true;
            continue;
        }
        after_space = false;
        // U+0130 is the one letter whose lower case is two code points.
        if (c == 0x130)
            result.append(static_cast<UChar32>('i')).append(static_cast<UChar32>(0x307));
        else
            result.append(u_tolower(c));
    }
    return to_utf8(result);
}

std::vector<std::string> split_for_clip(const std::string& utf8) {
    const icu::UnicodeString text = icu::UnicodeString::fromUTF8(utf8);
    std::vector<std::string> pieces;
    int at = 0;
    const auto emit = [&](int end) {
        pieces.push_back(to_utf8(text.tempSubStringBetween(at, end)));
        at = end;
    };
    const auto run = [&](const auto& belongs) {
        int end = at;
        while (end < text.length() && belongs(text.char32At(end)))
            end = text.moveIndex32(end, 1);
        return end;
    };
    while (at < text.length()) {
        const UChar32 c = text.char32At(at);
        if (is_space(c)) {
            at = text.moveIndex32(at, 1);
        } else if (const int length = c == '\'' ? contraction_length(text, at) : 0) {
            emit(at + length);
        } else if (is_letter(c)) {
            emit(run(is_letter));
        } else if (is_number(c)) {
            emit(text.moveIndex32(at, 1));
        } else {
            emit(run([](UChar32 d) { return !is_space(d) && !is_letter(d) && !is_number(d); }));
        }
    }
    return pieces;
}

std::string to_valid_utf8(const std::string& bytes) {
    return to_utf8(icu::UnicodeString::fromUTF8(bytes));
}

std::string strip_white_space(const std::string& utf8) {
    const icu::UnicodeString text = icu::UnicodeString::fromUTF8(utf8);
    // Python's strip, which the reference uses, also takes the four separators of ASCII.
    const auto blank = [](UChar32 c) { return is_space(c) || (c >= 0x1c && c <= 0x1f); };
    int begin = 0, end = text.length();
    while (begin < end && blank(text.char32At(begin)))
        ++begin;
    while (end > begin && blank(text.char32At(end - 1)))
        --end;
    return to_utf8(text.tempSubStringBetween(begin, end));
}

const std::vector<std::string>& byte_symbols() {
    static const std::vector<std::string> symbols = [] {
        std::vector<std::string> result(256);
        int spare = 256;  // bytes that are no visible Latin-1 character take these, in order
        for (int byte = 0; byte < 256; ++byte) {
            const bool visible = (byte >= '!' && byte <= '~') || (byte >= 0xa1 && byte <= 0xac) ||
                                 (byte >= 0xae && byte <= 0xff);
            result[byte] =
                to_utf8(icu::UnicodeString(static_cast<UChar32>(visible ? byte : spare++)));
        }
        return result;
    }();
    return symbols;
}

std::string bytes_of_symbols(const std::string& token) {
    static const std::unordered_map<std::string, char> bytes = [] {
        std::unordered_map<std::string, char> result;
        for (int byte = 0; byte < 256; ++byte)
            result[byte_symbols()[byte]] = static_cast<char>(byte);
        return result;
    }();
    std::string result;
    for (const std::string& symbol : code_points(token)) {
        const auto found = bytes.find(symbol);
        if (found == bytes.end()) return token;
        result += found->second;
    }
    return result;
}

std::vector<std::string> code_points(const std::string& text) {
    std::vector<std::string> result;
    for (std::size_t i = 0; i < text.size();) {
        std::size_t end = i + 1;
        while (end < text.size() && (text[end] & 0xc0) == 0x80)
            ++end;
        result.push_back(text.substr(i, end - i));
        i = end;
    }
    return result;
}

}  // namespace item3d
