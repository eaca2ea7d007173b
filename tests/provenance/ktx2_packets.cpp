// Tests of XMP packets in KTX 2.0 files.
#include "item3d/core/digest.h"
#include "item3d/provenance/image_packet.h"
#include "item3d/provenance/ktx2_packet.h"

#include <gtest/gtest.h>

#include <cstring>

namespace item3d {
namespace {

Bytes ktx2_file(const std::string& name) {
    return read_bytes(std::filesystem::path(ITEM3D_TEST_DATA) / "scene/images" / (name + ".ktx2"));
}

template <typename T>
T number_at(const Bytes& file, std::size_t at) {
    T value;
    std::memcpy(&value, file.data() + at, sizeof value);
    return value;
}

template <typename T>
void set_number(Bytes& file, std::size_t at, T value) {
    std::memcpy(file.data() + at, &value, sizeof value);
}

Bytes level_of(const Bytes& file, std::size_t level) {
    const auto offset = number_at<std::uint64_t>(file, 80 + 24 * level);
    const auto begin = file.begin() + static_cast<std::ptrdiff_t>(offset);
    return {begin, begin + static_cast<std::ptrdiff_t>(
                               number_at<std::uint64_t>(file, 80 + 24 * level + 8))};
}

std::vector<std::string> keys_of(const Bytes& file) {
    std::vector<std::string> keys;
    std::size_t at = number_at<std::uint32_t>(file, 56);
    const std::size_t end = at + number_at<std::uint32_t>(file, 60);
    while (at < end) {
        keys.emplace_back(reinterpret_cast<const char*>(file.data() + at + 4));
        at += 4 + (number_at<std::uint32_t>(file, at) + 3) / 4 * 4;
    }
    EXPECT_EQ(at, end);
    return keys;
}

TEST(Ktx2Packet, StandsBetweenTheKeysAndAllElseStays) {
    // The files are ETC1S with codebooks, plain UASTC, and UASTC in Zstandard; they have one level
    // or five.
    for (const char* name : {"etc1s", "etc1s_alpha", "uastc", "uastc_zstd"}) {
        SCOPED_TRACE(name);
        const Bytes file = ktx2_file(name);
        EXPECT_FALSE(find_packet(file));
        EXPECT_EQ(image_sha256(file), sha256(file));
        for (std::size_t size = 1; size < 70; ++size) {
            const std::string packet(size, 'x');
            const Bytes written = with_packet(file, packet);
            ASSERT_EQ(find_packet(written), packet);
            EXPECT_EQ(image_sha256(written), sha256(file));
            EXPECT_EQ(ktx2_with_packet(written, std::nullopt), file);
            EXPECT_EQ(with_packet(with_packet(file, "first"), packet), written);
            for (std::uint32_t level = 0; level < number_at<std::uint32_t>(file, 40); ++level)
                EXPECT_EQ(level_of(written, level), level_of(file, level));
            // Codebooks are aligned to eight bytes, blocks of plain UASTC to sixteen.
            EXPECT_EQ(number_at<std::uint64_t>(written, 64) % 8, 0u);
            if (number_at<std::uint32_t>(file, 44) == 0) {
                EXPECT_EQ(number_at<std::uint64_t>(written, 80) % 16, 0u);
            }
        }
    }
    const std::vector<std::string> keys = {"KTXwriter", "XML:com.adobe.xmp", "\x7f\x7f"};
    EXPECT_EQ(keys_of(with_packet(ktx2_file("uastc"), "packet")), keys);
}

TEST(Ktx2Packet, FilesWithoutKeysGetThem) {
    Bytes file = ktx2_file("uastc_zstd");
    set_number<std::uint64_t>(file, 56, 0);
    const Bytes written = with_packet(file, "packet");
    EXPECT_EQ(keys_of(written), std::vector<std::string>{"XML:com.adobe.xmp"});
    const Bytes without = ktx2_with_packet(written, std::nullopt);
    EXPECT_EQ(number_at<std::uint64_t>(without, 56), 0u);
    EXPECT_EQ(image_sha256(written), sha256(without));
}

TEST(Ktx2Packet, OtherPixelsOrKeysAreAnotherImage) {
    const Bytes file = with_packet(ktx2_file("uastc"), "packet");
    for (const std::size_t at : {std::size_t{25}, file.size() - 1, std::size_t{165}}) {
        Bytes other = file;
        other[at] ^= 1;
        EXPECT_NE(image_sha256(other), image_sha256(file)) << at;
    }
}

TEST(Ktx2Packet, IndicesThatNameTooMuchAreDamaged) {
    const Bytes file = with_packet(ktx2_file("etc1s_alpha"), "packet");
    const auto expect_damaged = [&](const auto& change) {
        Bytes other = file;
        change(other);
        EXPECT_FALSE(find_packet(other));
        EXPECT_EQ(with_packet(other, "new"), other);
        EXPECT_EQ(image_sha256(other), sha256(other));
    };
    expect_damaged([](Bytes& one) { set_number<std::uint32_t>(one, 40, 4000000000u); });
    expect_damaged([](Bytes& one) { set_number<std::uint64_t>(one, 64, ~std::uint64_t{0}); });
    expect_damaged([](Bytes& one) { set_number<std::uint32_t>(one, 60, 1u << 30); });
    // Each level claims the whole file.
    expect_damaged([](Bytes& one) {
        for (std::size_t level = 0; level < 5; ++level) {
            set_number<std::uint64_t>(one, 80 + 24 * level, 0);
            set_number<std::uint64_t>(one, 88 + 24 * level, one.size());
        }
    });
    const std::size_t keys = number_at<std::uint32_t>(file, 56);
    for (const std::uint32_t size : {0u, 1u, 8u, 4096u, ~0u})
        expect_damaged([&](Bytes& one) { set_number<std::uint32_t>(one, keys, size); });
}

}  // namespace
}  // namespace item3d
