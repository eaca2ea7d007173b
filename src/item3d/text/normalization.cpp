#include "item3d/text/normalization.h"

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

/// Returns the length of the contraction ('s, 't, 're, ...) at `at`; 0 if there is none.
int contraction_length(const icu::UnicodeString& text, int at) {
    static const char* const endings[] = {"'s", "'t", "'re", "'ve", "'m", "'ll", "'d"};
    for (const char* ending : endings) {
        const icu::UnicodeString wanted(ending, -1, US_INV);
        if (text.compare(at, wanted.length(), wanted) == 0) return wanted.length();
    }
    return 0;
}

/// Appends the lower case of one letter, independent of its context.
void append_lower(icu::UnicodeString& text, UChar32 c) {
    // U+0130 is the only letter whose lower case is two code points.
    if (c == 0x130)
        text.append(static_cast<UChar32>('i')).append(static_cast<UChar32>(0x307));
    else
        text.append(u_tolower(c));
}

bool is_control(UChar32 c) {
    const auto other = U_GC_CC_MASK | U_GC_CF_MASK | U_GC_CS_MASK | U_GC_CO_MASK;
    return c == 0 || c == 0xfffd || (U_GET_GC_MASK(c) & other) != 0;
}

/// True for BERT's punctuation, which includes ASCII symbols.
bool is_punctuation(UChar32 c) {
    const bool ascii = (c >= '!' && c <= '/') || (c >= ':' && c <= '@') || (c >= '[' && c <= '`') ||
                       (c >= '{' && c <= '~');
    return ascii || (U_GET_GC_MASK(c) & U_GC_P_MASK) != 0;
}

/// True for the CJK blocks in BERT's tokenizer, without newer extensions.
bool is_ideograph(UChar32 c) {
    return (c >= 0x4e00 && c <= 0x9fff) || (c >= 0x3400 && c <= 0x4dbf) ||
           (c >= 0x20000 && c <= 0x2a6df) || (c >= 0x2a700 && c <= 0x2b73f) ||
           (c >= 0x2b740 && c <= 0x2b81f) || (c >= 0x2b920 && c <= 0x2ceaf) ||
           (c >= 0xf900 && c <= 0xfaff) || (c >= 0x2f800 && c <= 0x2fa1f);
}

/// Calls f for each code point.
template <typename F>
void for_each_code_point(const icu::UnicodeString& text, const F& f) {
    for (int i = 0; i < text.length(); i = text.moveIndex32(i, 1))
        f(text.char32At(i));
}

/// Returns the end of the run of matching characters from `at` on.
template <typename F>
int end_of_run(const icu::UnicodeString& text, int at, const F& belongs) {
    while (at < text.length() && belongs(text.char32At(at)))
        at = text.moveIndex32(at, 1);
    return at;
}

bool is_symbol(UChar32 c) {
    return !is_space(c) && !is_letter(c) && !is_number(c);
}

}  // namespace

std::string normalize_for_clip(const std::string& text) {
    UErrorCode status = U_ZERO_ERROR;
    const icu::Normalizer2* nfc = icu::Normalizer2::getNFCInstance(status);
    const icu::UnicodeString composed = nfc->normalize(icu::UnicodeString::fromUTF8(text), status);
    ITEM3D_CHECK(U_SUCCESS(status), "ICU has no normalisation data");

    icu::UnicodeString result;
    bool after_space = false;
    for_each_code_point(composed, [&](UChar32 c) {
        if (!is_space(c))
            append_lower(result, c);
        else if (!after_space)
            result.append(static_cast<UChar32>(' '));
        after_space = is_space(c);
    });
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
    while (at < text.length()) {
        const UChar32 c = text.char32At(at);
        if (is_space(c)) {
            at = text.moveIndex32(at, 1);
        } else if (const int length = c == '\'' ? contraction_length(text, at) : 0) {
            emit(at + length);
        } else if (is_letter(c)) {
            emit(end_of_run(text, at, is_letter));
        } else if (is_number(c)) {
            emit(text.moveIndex32(at, 1));
        } else {
            emit(end_of_run(text, at, is_symbol));
        }
    }
    return pieces;
}

std::vector<std::string> split_for_gpt2(const std::string& utf8) {
    const icu::UnicodeString text = icu::UnicodeString::fromUTF8(utf8);
    std::vector<std::string> pieces;
    for (int at = 0; at < text.length();) {
        const int word = text[at] == ' ' ? at + 1 : at;  // a space belongs to the word after it
        const UChar32 c = word < text.length() ? text.char32At(word) : ' ';
        int end = at;
        if (text[at] == '\'' && contraction_length(text, at) > 0) {
            end = at + contraction_length(text, at);
        } else if (is_letter(c)) {
            end = end_of_run(text, word, is_letter);
        } else if (is_number(c)) {
            end = end_of_run(text, word, is_number);
        } else if (!is_space(c)) {
            end = end_of_run(text, word, is_symbol);
        } else {
            end = end_of_run(text, at, is_space);
            const int last = text.moveIndex32(end, -1);
            if (end < text.length() && last > at)
                end = last;  // the last space may belong to the next piece
        }
        pieces.push_back(to_utf8(text.tempSubStringBetween(at, end)));
        at = end;
    }
    return pieces;
}

std::string normalize_for_bert(const std::string& utf8, const BertNormalization& options) {
    icu::UnicodeString clean;
    for_each_code_point(icu::UnicodeString::fromUTF8(utf8), [&](UChar32 c) {
        // Includes tabs and line ends, which are control characters too.
        const bool blank = is_space(c);
        if (!blank && is_control(c)) return;
        const bool alone = options.separate_ideographs && is_ideograph(c);
        if (alone) clean.append(static_cast<UChar32>(' '));
        clean.append(blank ? static_cast<UChar32>(' ') : c);
        if (alone) clean.append(static_cast<UChar32>(' '));
    });
    if (options.strip_accents) {
        UErrorCode status = U_ZERO_ERROR;
        clean = icu::Normalizer2::getNFDInstance(status)->normalize(clean, status);
        ITEM3D_CHECK(U_SUCCESS(status), "ICU has no normalisation data");
    }
    icu::UnicodeString result;
    for_each_code_point(clean, [&](UChar32 c) {
        if (options.strip_accents && u_charType(c) == U_NON_SPACING_MARK) return;
        if (options.lower_case)
            append_lower(result, c);
        else
            result.append(c);
    });
    return to_utf8(result);
}

std::vector<std::string> split_for_bert(const std::string& utf8) {
    const icu::UnicodeString text = icu::UnicodeString::fromUTF8(utf8);
    std::vector<std::string> pieces;
    for (int at = 0; at < text.length();) {
        const UChar32 c = text.char32At(at);
        int end = text.moveIndex32(at, 1);
        if (!is_space(c)) {
            if (!is_punctuation(c))
                end = end_of_run(text, at,
                                 [](UChar32 d) { return !is_space(d) && !is_punctuation(d); });
            pieces.push_back(to_utf8(text.tempSubStringBetween(at, end)));
        }
        at = end;
    }
    return pieces;
}

std::string to_valid_utf8(const std::string& bytes) {
    return to_utf8(icu::UnicodeString::fromUTF8(bytes));
}

std::string strip_white_space(const std::string& utf8) {
    const icu::UnicodeString text = icu::UnicodeString::fromUTF8(utf8);
    // Python's strip(), which the reference implementation uses, also removes ASCII's four
    // separators.
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
        // Bytes without a visible Latin-1 character get the code points from 256 on, in order.
        int spare = 256;
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
