// Mutations of files that consist of a length, a JSON header and binary data. They keep the lengths
// right, because a plain mutation of such a file seldom gets past its first bytes.
#pragma once

#include "tests/fuzz/fuzz.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <random>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t maximum);

namespace item3d::fuzz {

struct Framed {
    std::string json, binary;
};

inline std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}
inline std::string little_endian(std::uint32_t value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// Returns libFuzzer's own mutation of a part.
inline std::string mutated(std::string part, std::size_t maximum) {
    const std::size_t size = part.size();
    part.resize(std::max(maximum, size + 1));
    part.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(part.data()), size, part.size()));
    return part;
}

/// Returns the JSON with one number, string or word replaced. The new value is another one of the
/// same JSON, or one that overflows an integer or that no reader expects.
inline std::string with_other_value(const std::string& json, std::minstd_rand& random) {
    static constexpr std::array values = {"0",
                                          "1",
                                          "-1",
                                          "2",
                                          "255",
                                          "65536",
                                          "2147483647",
                                          "-2147483648",
                                          "4294967296",
                                          "9007199254740993",
                                          "9223372036854775807",
                                          "18446744073709551615",
                                          "1e39",
                                          "1e308",
                                          "1e999",
                                          "0.5",
                                          "null",
                                          "true",
                                          "\"\"",
                                          "[]",
                                          "{}",
                                          "[0]",
                                          "[[]]",
                                          "\"..\""};
    std::vector<std::pair<std::size_t, std::size_t>> tokens;
    for (std::size_t i = 0; i < json.size(); ++i) {
        std::size_t end = i;
        if (json[i] == '"')
            end = std::min(json.find('"', i + 1), json.size() - 1) + 1;
        else
            while (end < json.size() && (std::isalnum(static_cast<unsigned char>(json[end])) ||
                                         std::strchr("+-.", json[end])))
                ++end;
        if (end == i) continue;
        tokens.emplace_back(i, end - i);
        i = end - 1;
    }
    if (tokens.empty()) return json;
    const auto [at, length] = tokens[random() % tokens.size()];
    const auto [other, other_length] = tokens[random() % tokens.size()];
    std::string result = json;
    if (random() % 4 == 0) return result.replace(at, length, json, other, other_length);
    return result.replace(at, length, values[random() % values.size()]);
}

/// Replaces the input by a mutation of its parts. `split` returns nothing for an input without such
/// parts, which is mutated as plain bytes.
inline std::size_t mutate_framed(std::uint8_t* data, std::size_t size, std::size_t maximum,
                                 unsigned seed, std::optional<Framed> (*split)(const std::string&),
                                 std::string (*join)(const Framed&)) {
    std::minstd_rand random(seed);
    auto parts = split(as_text(data, size));
    if (!parts || random() % 16 == 0) return LLVMFuzzerMutate(data, size, maximum);
    switch (random() % 4) {
        case 0:
            parts->binary = mutated(parts->binary, parts->binary.size() + 64);
            break;
        case 1:
            parts->json = mutated(parts->json, parts->json.size() + 64);
            break;
        default:
            parts->json = with_other_value(parts->json, random);
    }
    const std::string whole = join(*parts);
    if (whole.size() > maximum) return LLVMFuzzerMutate(data, size, maximum);
    std::copy(whole.begin(), whole.end(), data);
    return whole.size();
}

/// Splits safetensors: a length of 64 bits, JSON, and data.
inline std::optional<Framed> split_safetensors(const std::string& bytes) {
    if (bytes.size() < 8 || little_endian(bytes, 4) != 0) return std::nullopt;
    const std::size_t length = little_endian(bytes, 0);
    if (length > bytes.size() - 8) return std::nullopt;
    return Framed{bytes.substr(8, length), bytes.substr(8 + length)};
}
inline std::string join_safetensors(const Framed& parts) {
    return little_endian(static_cast<std::uint32_t>(parts.json.size())) + std::string(4, '\0') +
           parts.json + parts.binary;
}

/// Splits GLB: "glTF", the version 2, the length of the file; then chunks of JSON and of binary
/// data, each after its length and kind.
inline std::optional<Framed> split_glb(const std::string& bytes) {
    if (bytes.size() < 20 || !bytes.starts_with("glTF")) return std::nullopt;
    const std::size_t length = little_endian(bytes, 12), end = 20 + length;
    if (end > bytes.size()) return std::nullopt;
    return Framed{bytes.substr(20, length),
                  end + 8 > bytes.size() ? std::string() : bytes.substr(end + 8)};
}
inline std::string join_glb(const Framed& parts) {
    const auto chunk = [](const char* kind, std::string content, char padding) {
        content.resize((content.size() + 3) / 4 * 4, padding);
        return little_endian(static_cast<std::uint32_t>(content.size())) + std::string(kind, 4) +
               content;
    };
    std::string chunks = chunk("JSON", parts.json, ' ');
    if (!parts.binary.empty()) chunks += chunk("BIN", parts.binary, '\0');
    return "glTF" + little_endian(2) +
           little_endian(static_cast<std::uint32_t>(chunks.size() + 12)) + chunks;
}

/// Mutates JSON that follows `prefix` bytes. These bytes choose what reads the JSON.
template <std::size_t prefix>
std::size_t mutate_json(std::uint8_t* data, std::size_t size, std::size_t maximum, unsigned seed) {
    std::minstd_rand random(seed);
    if (size <= prefix || random() % 2 == 0) return LLVMFuzzerMutate(data, size, maximum);
    const std::string json = with_other_value(as_text(data + prefix, size - prefix), random);
    if (prefix + json.size() > maximum) return LLVMFuzzerMutate(data, size, maximum);
    std::copy(json.begin(), json.end(), data + prefix);
    return prefix + json.size();
}

}  // namespace item3d::fuzz

/// Defines the mutation of a target's inputs in a libFuzzer program.
#ifdef ITEM3D_FUZZ_ALONE
#define ITEM3D_FUZZ_MUTATOR(mutation)                                                    \
    extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, \
                                                   std::size_t maximum, unsigned seed) { \
        return mutation;                                                                 \
    }
#else
#define ITEM3D_FUZZ_MUTATOR(mutation)
#endif
