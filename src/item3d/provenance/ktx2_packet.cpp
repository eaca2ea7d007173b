#include "item3d/provenance/ktx2_packet.h"

#include "item3d/provenance/xmp.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <vector>

namespace item3d {
namespace {

using Span = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 12> identifier = {0xab, 'K',  'T',  'X',  ' ',  '2',
                                                     '0',  0xbb, '\r', '\n', 0x1a, '\n'};
constexpr std::size_t level_count_at = 40, scheme_at = 44, index_at = 48, levels_at = 80;
constexpr std::size_t level_entry_size = 24;
/// Offset in a data format descriptor of the size of a texel block in bytes.
constexpr std::size_t block_size_at = 20;
constexpr std::uint32_t max_levels = 32;

template <typename T>
T number_at(Span bytes, std::size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

template <typename T>
void set_number(Bytes& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

void append(Bytes& out, Span part) {
    out.insert(out.end(), part.begin(), part.end());
}

void pad(Bytes& out, std::size_t alignment) {
    out.resize((out.size() + alignment - 1) / alignment * alignment);
}

/// A key, its NUL and its value.
using Pair = Span;

std::string_view key_of(Pair pair) {
    const auto end = std::find(pair.begin(), pair.end(), std::uint8_t{0});
    return {reinterpret_cast<const char*>(pair.data()),
            static_cast<std::size_t>(end - pair.begin())};
}

struct Ktx2Parts {
    Span descriptor, codebooks;
    std::vector<Pair> pairs;
    std::vector<Span> levels;  ///< largest first
};

/// Reader of the parts that the file's index lists. The parts must not overlap.
class Ktx2Reader {
  public:
    explicit Ktx2Reader(Span file) : file_(file), left_(file.size()) {}

    /// Returns nullopt for a damaged file.
    std::optional<Ktx2Parts> read() {
        if (file_.size() < levels_at) return std::nullopt;
        const std::uint32_t count = std::max(number_at<std::uint32_t>(file_, level_count_at), 1u);
        const std::size_t header = levels_at + count * level_entry_size;
        if (count > max_levels || header > file_.size()) return std::nullopt;
        left_ -= header;
        Ktx2Parts parts;
        parts.descriptor = part_at<std::uint32_t>(index_at);
        read_pairs(part_at<std::uint32_t>(index_at + 8), parts.pairs);
        parts.codebooks = part_at<std::uint64_t>(index_at + 16);
        for (std::size_t level = 0; level < count; ++level)
            parts.levels.push_back(part_at<std::uint64_t>(levels_at + level * level_entry_size));
        return is_damaged_ ? std::nullopt : std::optional(parts);
    }

  private:
    /// Returns the part whose offset and length are stored at byte `at` of the file.
    template <typename T>
    Span part_at(std::size_t at) {
        const std::uint64_t offset = number_at<T>(file_, at);
        const std::uint64_t length = number_at<T>(file_, at + sizeof(T));
        if (length == 0) return {};
        if (offset > file_.size() || length > file_.size() - offset || length > left_) {
            is_damaged_ = true;
            return {};
        }
        left_ -= static_cast<std::size_t>(length);
        return file_.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
    }

    void read_pairs(Span data, std::vector<Pair>& pairs) {
        while (!data.empty()) {
            const std::size_t size = data.size() < 4 ? 0 : number_at<std::uint32_t>(data, 0);
            if (size < 2 || size > data.size() - 4) {
                is_damaged_ = true;
                return;
            }
            const Pair pair = data.subspan(4, size);
            if (key_of(pair).size() == size) is_damaged_ = true;
            pairs.push_back(pair);
            data = data.subspan(std::min(data.size(), 4 + (size + 3) / 4 * 4));
        }
    }

    Span file_;
    std::size_t left_;
    bool is_damaged_ = false;
};

std::optional<Ktx2Parts> parts_of(Span image) {
    return is_ktx2(image) ? Ktx2Reader(image).read() : std::nullopt;
}

void append_pair(Bytes& out, Pair pair) {
    const std::size_t at = out.size();
    out.resize(at + 4);
    set_number(out, at, static_cast<std::uint32_t>(pair.size()));
    append(out, pair);
    pad(out, 4);
}

/// Returns the bytes of the pairs and the packet, with keys sorted by code point.
Bytes pairs_with_packet(const std::vector<Pair>& pairs, const std::optional<std::string>& packet) {
    Bytes own;
    if (packet) {
        own.assign(ktx2_packet_key.begin(), ktx2_packet_key.end());
        own.push_back(0);
        own.insert(own.end(), packet->begin(), packet->end());
        own.push_back(0);
    }
    Bytes out;
    for (const Pair pair : pairs) {
        if (key_of(pair) == ktx2_packet_key) continue;
        if (!own.empty() && key_of(pair) > ktx2_packet_key) {
            append_pair(out, own);
            own.clear();
        }
        append_pair(out, pair);
    }
    if (!own.empty()) append_pair(out, own);
    return out;
}

/// Returns the alignment of levels in bytes; 1 if they are supercompressed.
std::size_t level_alignment(Span image, Span descriptor) {
    if (number_at<std::uint32_t>(image, scheme_at) != 0) return 1;
    const std::size_t block =
        descriptor.size() > block_size_at ? descriptor[block_size_at] : std::size_t{0};
    return std::lcm(std::max<std::size_t>(block, 1), std::size_t{4});
}

/// Appends a part and writes its offset and length into the index. An empty part gets offset 0.
template <typename T>
void append_indexed(Bytes& out, Span part, std::size_t alignment, std::size_t at) {
    if (!part.empty()) pad(out, alignment);
    set_number(out, at, static_cast<T>(part.empty() ? 0 : out.size()));
    set_number(out, at + sizeof(T), static_cast<T>(part.size()));
    append(out, part);
}

}  // namespace

bool is_ktx2(Span image) {
    return image.size() >= identifier.size() &&
           std::equal(identifier.begin(), identifier.end(), image.begin());
}

std::optional<std::string> find_ktx2_packet(Span image) {
    const auto parts = parts_of(image);
    if (!parts) return std::nullopt;
    for (const Pair pair : parts->pairs) {
        if (key_of(pair) != ktx2_packet_key) continue;
        const Span value = pair.subspan(ktx2_packet_key.size() + 1);
        std::string packet(reinterpret_cast<const char*>(value.data()), value.size());
        if (packet.ends_with('\0')) packet.pop_back();
        return packet;
    }
    return std::nullopt;
}

Bytes ktx2_with_packet(Span image, const std::optional<std::string>& packet) {
    const auto parts = parts_of(image);
    if (!parts || (packet && packet->size() > largest_packet)) return {};
    Bytes out(image.begin(), image.begin() + levels_at);
    append(out, image.subspan(levels_at, parts->levels.size() * level_entry_size));
    append_indexed<std::uint32_t>(out, parts->descriptor, 4, index_at);
    append_indexed<std::uint32_t>(out, pairs_with_packet(parts->pairs, packet), 4, index_at + 8);
    append_indexed<std::uint64_t>(out, parts->codebooks, 8, index_at + 16);
    const std::size_t alignment = level_alignment(image, parts->descriptor);
    // Levels are stored from the smallest to the largest.
    for (std::size_t level = parts->levels.size(); level-- > 0;)
        append_indexed<std::uint64_t>(out, parts->levels[level], alignment,
                                      levels_at + level * level_entry_size);
    return out;
}

}  // namespace item3d
