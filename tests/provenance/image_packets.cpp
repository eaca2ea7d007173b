// Tests of XMP packets in image files.
#include "item3d/core/digest.h"
#include "item3d/provenance/image_packet.h"
#include "item3d/provenance/xmp.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string_view>
#include <vector>

namespace item3d {
namespace {

Bytes bytes_of(std::string_view text) {
    return {text.begin(), text.end()};
}

void add(Bytes& out, std::string_view text) {
    out.insert(out.end(), text.begin(), text.end());
}

void add_png_chunk(Bytes& png, std::string_view type, std::string_view data) {
    for (int shift = 24; shift >= 0; shift -= 8)
        png.push_back(static_cast<std::uint8_t>(data.size() >> shift & 255));
    add(png, type);
    add(png, data);
    add(png, "crc.");
}

Bytes small_png() {
    Bytes png = bytes_of("\x89PNG\r\n\x1a\n");
    add_png_chunk(png, "IHDR", "0123456789abc");
    add_png_chunk(png, "tEXt", std::string_view("Author\0me", 9));
    add_png_chunk(png, "IDAT", "pixels");
    add_png_chunk(png, "IEND", "");
    return png;
}

void add_segment(Bytes& jpeg, std::uint8_t marker, std::string_view data) {
    const std::size_t size = data.size() + 2;
    for (const std::size_t byte : {std::size_t{0xff}, std::size_t{marker}, size >> 8, size & 255})
        jpeg.push_back(static_cast<std::uint8_t>(byte));
    add(jpeg, data);
}

Bytes small_jpeg() {
    Bytes jpeg = bytes_of("\xff\xd8");
    add_segment(jpeg, 0xe0, "JFIF..");
    add_segment(jpeg, 0xdb, "tables");
    add_segment(jpeg, 0xda, "scan");
    add(jpeg, "\x12\x34\xff\xd9");
    return jpeg;
}

// Returns a lossless WebP of 1 x 1 pixels.
Bytes small_webp() {
    return bytes_of(
        std::string_view("RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\0\0\0\x10\x07\x10\x11"
                         "\x11\x88\x88\xfe\x07\0",
                         34));
}

Bytes small_ktx2() {
    return read_bytes(std::filesystem::path(ITEM3D_TEST_DATA) / "scene/images/etc1s.ktx2");
}

TEST(ImagePacket, IsPutAndFoundAndLeavesTheHash) {
    for (const Bytes& image : {small_png(), small_jpeg(), small_webp(), small_ktx2()}) {
        SCOPED_TRACE(static_cast<int>(packet_container(image)));
        ASSERT_NE(packet_container(image), PacketContainer::none);
        EXPECT_FALSE(find_packet(image));
        const Bytes first = with_packet(image, "first packet");
        EXPECT_EQ(find_packet(first), "first packet");
        const Bytes second = with_packet(first, "second");
        EXPECT_EQ(find_packet(second), "second");
        EXPECT_EQ(second, with_packet(image, "second"));
        EXPECT_EQ(image_sha256(image), image_sha256(second));
        Bytes other = image;
        other[other.size() - 5] ^= 1;
        EXPECT_NE(image_sha256(other), image_sha256(second));
    }
    const Bytes text = bytes_of("not an image");
    EXPECT_EQ(with_packet(text, "packet"), text);
    EXPECT_EQ(image_sha256(text), sha256(text));
}

TEST(ImagePacket, StandsBehindTheHeader) {
    const Bytes png = with_packet(small_png(), "packet");
    const std::string_view text(reinterpret_cast<const char*>(png.data()), png.size());
    EXPECT_LT(text.find("IHDR"), text.find("XML:com.adobe.xmp"));
    EXPECT_LT(text.find("XML:com.adobe.xmp"), text.find("IDAT"));
    const Bytes jpeg = with_packet(small_jpeg(), "packet");
    EXPECT_EQ(jpeg[3], 0xe0);
    EXPECT_EQ(jpeg[13], 0xe1);
    EXPECT_EQ(jpeg.back(), 0xd9);
}

TEST(ImagePacket, OneTooLargeForAJpegIsLeftOut) {
    EXPECT_EQ(with_packet(small_jpeg(), std::string(65505, 'x')), small_jpeg());
    const std::string largest(65504, 'x');
    EXPECT_EQ(find_packet(with_packet(small_jpeg(), largest)), largest);
    EXPECT_EQ(find_packet(with_packet(small_png(), std::string(200000, 'x')))->size(), 200000u);
}

TEST(ImagePacket, CompressedOnesOfOthersAreRead) {
    Bytes png = bytes_of("\x89PNG\r\n\x1a\n");
    add_png_chunk(png, "IHDR", "0123456789abc");
    // The packet is the text "hello", compressed by zlib.
    const std::string_view compressed(
        "XML:com.adobe.xmp\0\1\0en\0title\0\x78\x9c\xcb\x48\xcd\xc9\xc9\x07\x00\x06\x2c\x02\x15",
        42);
    add_png_chunk(png, "iTXt", compressed);
    EXPECT_EQ(find_packet(png), "hello");
    add_png_chunk(png, "IEND", "");
    EXPECT_EQ(find_packet(with_packet(png, "new")), "new");
}

TEST(ImagePacket, DamagedFilesAreReadWithoutHarm) {
    for (const Bytes& image :
         {with_packet(small_png(), "packet"), with_packet(small_jpeg(), "packet"),
          with_packet(small_webp(), "packet"), with_packet(small_ktx2(), "packet")}) {
        for (std::size_t size = 0; size < image.size(); ++size) {
            const Bytes cut(image.begin(), image.begin() + static_cast<std::ptrdiff_t>(size));
            find_packet(cut);
            EXPECT_EQ(image_sha256(cut).size(), 64u);
            with_packet(cut, "other");
        }
        for (std::size_t i = 0; i < image.size(); ++i)
            for (const int bit : {0, 3, 7}) {
                Bytes changed = image;
                changed[i] = static_cast<std::uint8_t>(changed[i] ^ 1 << bit);
                find_packet(changed);
                with_packet(changed, "other");
                image_sha256(changed);
            }
    }
}

}  // namespace
}  // namespace item3d
