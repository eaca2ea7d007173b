// Tests of images of every format, valid and damaged.
#include "item3d/core/error.h"
#include "item3d/io/texture_format.h"
#include "tests/support/textured.h"

#include <algorithm>
#include <functional>

namespace item3d {
namespace {

using namespace testing_support;

void put_number(Bytes& bytes, std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i)
        bytes.push_back(static_cast<std::uint8_t>(i < 8 ? value >> (8 * i) & 255 : 0));
}

std::uint8_t byte_of(float value) {
    return static_cast<std::uint8_t>(std::lround(value * 255.0f));
}

// Makes a BMP from bottom to top, rows padded to four bytes.
Bytes make_bmp(const Image& image) {
    const int row = (image.width * 3 + 3) / 4 * 4;
    Bytes bytes{'B', 'M'};
    put_number(bytes, 54 + static_cast<std::uint64_t>(row) * image.height, 4);
    put_number(bytes, 0, 4);
    put_number(bytes, 54, 4);
    put_number(bytes, 40, 4);
    put_number(bytes, image.width, 4);
    put_number(bytes, image.height, 4);
    put_number(bytes, 1, 2);
    put_number(bytes, 24, 2);
    put_number(bytes, 0, 24);
    for (int y = image.height - 1; y >= 0; --y) {
        for (int x = 0; x < image.width; ++x)
            for (int c = 2; c >= 0; --c)
                bytes.push_back(byte_of(image.at(x, y, c)));
        put_number(bytes, 0, row - 3 * image.width);
    }
    return bytes;
}

// Makes a TGA from top to bottom. If `is_packed` is true, each pixel is a run of length one.
Bytes make_tga(const Image& image, bool is_packed) {
    Bytes bytes{0, 0, static_cast<std::uint8_t>(is_packed ? 10 : 2)};
    put_number(bytes, 0, 5);
    put_number(bytes, 0, 4);
    put_number(bytes, image.width, 2);
    put_number(bytes, image.height, 2);
    bytes.push_back(static_cast<std::uint8_t>(8 * image.channels));
    bytes.push_back(0x20);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (is_packed) bytes.push_back(0x80);
            for (int c = 2; c >= 0; --c)
                bytes.push_back(byte_of(image.at(x, y, c)));
            if (image.channels == 4) bytes.push_back(byte_of(image.at(x, y, 3)));
        }
    }
    return bytes;
}

// Makes a TIFF of one strip without compression.
Bytes make_tiff(const Image& image, int bits) {
    Bytes bytes{'I', 'I', 42, 0};
    put_number(bytes, 8, 4);
    const int entries = image.channels == 4 ? 9 : 8;
    const std::uint64_t bits_at = 8 + 2 + 12 * static_cast<std::uint64_t>(entries) + 4;
    const std::uint64_t data_at = bits_at + 8;
    const std::size_t size = image.pixels.size() * static_cast<std::size_t>(bits / 8);
    put_number(bytes, static_cast<std::uint64_t>(entries), 2);
    const auto entry = [&](int tag, int type, std::uint64_t count, std::uint64_t value) {
        put_number(bytes, static_cast<std::uint64_t>(tag), 2);
        put_number(bytes, static_cast<std::uint64_t>(type), 2);
        put_number(bytes, count, 4);
        put_number(bytes, value, 4);
    };
    entry(256, 4, 1, image.width);
    entry(257, 4, 1, image.height);
    entry(258, 3, image.channels, bits_at);
    entry(259, 3, 1, 1);
    entry(262, 3, 1, 2);
    entry(273, 4, 1, data_at);
    entry(277, 3, 1, image.channels);
    entry(279, 4, 1, size);
    if (image.channels == 4) entry(338, 3, 1, 2);
    put_number(bytes, 0, 4);
    for (int c = 0; c < 4; ++c)
        put_number(bytes, bits, 2);
    for (const float value : image.pixels) {
        put_number(
            bytes,
            static_cast<std::uint64_t>(std::lround(value * (bits == 16 ? 65535.0f : 255.0f))),
            bits / 8);
    }
    return bytes;
}

// Makes a GIF of two colours, 4 x 4 pixels. The table is cleared after every two codes, so codes
// never get longer.
Bytes make_gif() {
    Bytes bytes{'G', 'I', 'F', '8', '9', 'a', 4, 0, 4, 0, 0x80, 0, 0};
    for (const int value : {255, 0, 0, 0, 0, 255})
        bytes.push_back(static_cast<std::uint8_t>(value));
    for (const int value : {0x2c, 0, 0, 0, 0, 4, 0, 4, 0, 0, 2})
        bytes.push_back(static_cast<std::uint8_t>(value));
    Bytes data;
    std::uint32_t bits = 0;
    int count = 0;
    const auto code = [&](std::uint32_t value) {
        bits |= value << count;
        count += 3;
        while (count >= 8) {
            data.push_back(static_cast<std::uint8_t>(bits & 255));
            bits >>= 8;
            count -= 8;
        }
    };
    for (std::uint32_t i = 0; i < 16; ++i) {
        if (i % 2 == 0) code(4);
        code((i + i / 4) % 2);
    }
    code(5);
    data.push_back(static_cast<std::uint8_t>(bits & 255));
    bytes.push_back(static_cast<std::uint8_t>(data.size()));
    bytes.insert(bytes.end(), data.begin(), data.end());
    bytes.push_back(0);
    bytes.push_back(';');
    return bytes;
}

Image decoded(const fs::path& folder, const Bytes& bytes, const std::string& name = "a.picture") {
    write_quickly(folder / name, bytes);
    return load_image(folder / name);
}

std::map<std::string, Bytes> images_of_every_format() {
    const Image rgb = test_image(3);
    const Image rgba = test_image(4);
    std::map<std::string, Bytes> images{
        {"png", encode_texture(rgb, {}, 8)},
        {"jpeg", encode_texture(rgb, {ImageEncoding::jpeg, false, 90}, 8)},
        {"webp", encode_texture(rgba, {ImageEncoding::webp, true, 95}, 8)},
        {"webp with losses", encode_texture(rgb, {ImageEncoding::webp, false, 90}, 8)},
        {"bmp", make_bmp(rgb)},
        {"tga", make_tga(rgba, false)},
        {"packed tga", make_tga(rgb, true)},
        {"gif", make_gif()},
        {"tiff", make_tiff(rgb, 8)}};
    for (const char* name : {"etc1s", "etc1s_alpha", "uastc", "uastc_zstd"}) {
        images[name] = read_bytes(data_folder() / "images" / (std::string(name) + ".ktx2"));
    }
    return images;
}

TEST(ImageFormats, WebpIsReadAndWritten) {
    const fs::path folder = fresh_folder("webp");
    for (const int channels : {3, 4}) {
        const Image image = checkered_image(31, 9, channels);
        const Bytes exact = encode_texture(image, {ImageEncoding::webp, true, 95}, 8);
        expect_same_image(decoded(folder, exact), image, 1e-6f);
    }
    const Image smooth = test_image(3, 31, 25);
    const Bytes lossy = encode_texture(smooth, {ImageEncoding::webp, false, 90}, 8);
    EXPECT_LT(mean_squared_error(decoded(folder, lossy), smooth), 4e-3);
    EXPECT_GT(mean_squared_error(decoded(folder, lossy), smooth), 0);
}

TEST(ImageFormats, Ktx2OfEveryKindIsRead) {
    const auto error = [&](const std::string& name, int channels) {
        const Image image = load_image(data_folder() / "images" / (name + ".ktx2"));
        const Image wanted = test_image(channels);
        EXPECT_EQ(image.width, wanted.width);
        EXPECT_EQ(image.height, wanted.height);
        EXPECT_EQ(image.channels, channels);
        if (image.pixels.size() != wanted.pixels.size()) return 1.0;
        return mean_squared_error(image, wanted);
    };
    EXPECT_LT(error("etc1s", 3), 2e-3);
    EXPECT_LT(error("etc1s_alpha", 4), 2e-3);
    EXPECT_LT(error("uastc", 3), 5e-4);
    EXPECT_LT(error("uastc_zstd", 4), 5e-4);
}

TEST(ImageFormats, BmpTgaTiffAndGifAreRead) {
    const fs::path folder = fresh_folder("others");
    const Image rgb = test_image(3);
    const Image rgba = test_image(4);
    expect_same_image(decoded(folder, make_bmp(rgb)), rgb, 1e-6f);
    for (const bool is_packed : {false, true}) {
        expect_same_image(decoded(folder, make_tga(rgb, is_packed)), rgb, 1e-6f);
        expect_same_image(decoded(folder, make_tga(rgba, is_packed)), rgba, 1e-6f);
    }
    for (const int bits : {8, 16}) {
        expect_same_image(decoded(folder, make_tiff(rgb, bits)), rgb, 1e-6f);
        expect_same_image(decoded(folder, make_tiff(rgba, bits)), rgba, 1e-6f);
    }
    const Image gif = decoded(folder, make_gif());
    ASSERT_EQ(gif.width, 4);
    ASSERT_EQ(gif.height, 4);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) {
            EXPECT_EQ(gif.at(x, y, 0), (x + y) % 2 == 0 ? 1.0f : 0.0f) << x << ' ' << y;
            EXPECT_EQ(gif.at(x, y, 2), (x + y) % 2 == 0 ? 0.0f : 1.0f) << x << ' ' << y;
        }
    }
}

TEST(ImageFormats, ThoseThatAreNotReadAreNamed) {
    const fs::path folder = fresh_folder("foreign");
    const std::map<std::string, std::string> kinds{
        {"DDS |...", "DDS"},
        {"8BPS....", "Photoshop"},
        {std::string("\0\0\0\x18", 4) + "ftypavif", "AVIF"},
        {"<!DOCTYPE html>", "web page"}};
    for (const auto& [content, name] : kinds) {
        try {
            decoded(folder, Bytes(content.begin(), content.end()));
            ADD_FAILURE() << name;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("PNG"), std::string::npos) << error.what();
        }
    }
}

TEST(ImageFormats, ContentCountsAndNotTheName) {
    const fs::path folder = fresh_folder("mislabelled");
    for (const auto& [format, bytes] : images_of_every_format()) {
        const Image image = decoded(folder, bytes, "a.ktx2");
        EXPECT_GT(image.width, 0) << format;
    }
}

// A file that is cut off anywhere is refused in one line, or complete if the lost bytes are
// redundant.
TEST(ImageFormats, CutImagesAreRefused) {
    const fs::path folder = fresh_folder("cut_pictures");
    for (const auto& [format, whole] : images_of_every_format()) {
        const Image wanted = decoded(folder, whole);
        for (std::size_t size = 0; size < whole.size(); size += size < 100 ? 1 : 37) {
            SCOPED_TRACE(format + " of " + std::to_string(size) + " bytes");
            try {
                const Image image = decoded(
                    folder,
                    Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
                EXPECT_GT(size, whole.size() - 20);
                expect_same_image(image, wanted);
            } catch (const InputError& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
                EXPECT_NE(std::string(error.what()).find("a.picture"), std::string::npos)
                    << error.what();
            }
        }
    }
}

TEST(ImageFormats, NoiseNeverCrashes) {
    const fs::path folder = fresh_folder("noise");
    std::uint32_t random = 99;
    const auto next = [&](std::size_t limit) {
        random = random * 1664525u + 1013904223u;
        return static_cast<std::size_t>(random >> 8) % limit;
    };
    for (const auto& [format, whole] : images_of_every_format()) {
        for (int i = 0; i < 60; ++i) {
            Bytes bytes = whole;
            // Headers contain most lengths and offsets. They are damaged as often as all other
            // bytes.
            const std::size_t limit =
                i % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 256);
            for (std::size_t k = 0; k < 1 + next(4); ++k)
                bytes[next(limit)] = static_cast<std::uint8_t>(next(256));
            SCOPED_TRACE(format + " " + std::to_string(i));
            try {
                for (const float value : decoded(folder, bytes).pixels)
                    ASSERT_TRUE(std::isfinite(value));
            } catch (const Error&) {
            }
        }
    }
}

}  // namespace
}  // namespace item3d
