// JPEG files with EXIF metadata.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/save.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d::testing {

/// Metadata to write; unset members are omitted.
struct WrittenMetadata {
    int orientation = 0;
    int focal_35 = 0;                    ///< 35 mm equivalent focal length in millimetres
    double focal = 0;                    ///< millimetres, stored in tenths
    double seconds = 0;                  ///< exposure time, stored in ten-thousandths
    double aperture = 0;                 ///< f-number, stored in tenths
    int sensitivity = 0;                 ///< ISO
    std::optional<double> shutter = {};  ///< APEX value, stored in tenths
    std::string camera = {};             ///< name of the camera model
    int width = 0, height = 0;           ///< stored size of the camera's image
};

/// Returns an APP1 segment: the text "Exif", then a TIFF file with one image directory and an EXIF
/// directory.
inline Bytes exif_segment(const WrittenMetadata& facts, bool big_endian) {
    Bytes tiff;
    const auto put = [&](std::uint32_t value, int count) {
        for (int i = 0; i < count; ++i)
            tiff.push_back(
                static_cast<std::uint8_t>(value >> 8 * (big_endian ? count - 1 - i : i)));
    };
    struct Entry {
        unsigned tag, type;
        std::uint32_t a, b;  // numerator and denominator of a rational, or a number in `a`
        std::string text;
    };
    const auto directory = [&](const std::vector<Entry>& entries) {
        put(static_cast<std::uint32_t>(entries.size()), 2);
        const std::size_t begin = tiff.size();
        Bytes data;
        std::uint32_t place = static_cast<std::uint32_t>(begin + 12 * entries.size() + 4);
        std::vector<Entry> behind;
        for (const Entry& entry : entries) {
            put(entry.tag, 2);
            put(entry.type, 2);
            put(entry.type == 2 ? static_cast<std::uint32_t>(entry.text.size() + 1) : 1, 4);
            if (entry.type == 3) {
                put(entry.a, 2);
                put(0, 2);
            } else if (entry.type == 4) {
                put(entry.a, 4);
            } else {
                put(place, 4);
                place += entry.type == 2 ? static_cast<std::uint32_t>(entry.text.size() + 1) : 8;
                behind.push_back(entry);
            }
        }
        put(0, 4);
        for (const Entry& entry : behind) {
            if (entry.type == 2) {
                tiff.insert(tiff.end(), entry.text.begin(), entry.text.end());
                tiff.push_back(0);
            } else {
                put(entry.a, 4);
                put(entry.b, 4);
            }
        }
    };
    constexpr unsigned text = 2, number = 3, offset = 4, quotient = 5, signed_quotient = 10;
    const auto parts = [](double value, int of) {
        return static_cast<std::uint32_t>(
            static_cast<std::int32_t>(value * of + (value < 0 ? -0.5 : 0.5)));
    };
    std::vector<Entry> inner;
    if (facts.seconds > 0)
        inner.push_back({0x829a, quotient, parts(facts.seconds, 10000), 10000, {}});
    if (facts.aperture > 0) inner.push_back({0x829d, quotient, parts(facts.aperture, 10), 10, {}});
    if (facts.sensitivity > 0)
        inner.push_back({0x8827, number, static_cast<std::uint32_t>(facts.sensitivity), 0, {}});
    if (facts.shutter)
        inner.push_back({0x9201, signed_quotient, parts(*facts.shutter, 10), 10, {}});
    if (facts.focal > 0) inner.push_back({0x920a, quotient, parts(facts.focal, 10), 10, {}});
    if (facts.width > 0)
        inner.push_back({0xa002, offset, static_cast<std::uint32_t>(facts.width), 0, {}});
    if (facts.height > 0)
        inner.push_back({0xa003, offset, static_cast<std::uint32_t>(facts.height), 0, {}});
    if (facts.focal_35 > 0)
        inner.push_back({0xa405, number, static_cast<std::uint32_t>(facts.focal_35), 0, {}});

    put(big_endian ? 0x4d4d : 0x4949, 2);
    put(42, 2);
    put(8, 4);
    std::vector<Entry> outer;
    if (!facts.camera.empty()) outer.push_back({0x0110, text, 0, 0, facts.camera});
    if (facts.orientation > 0)
        outer.push_back({0x0112, number, static_cast<std::uint32_t>(facts.orientation), 0, {}});
    const std::size_t behind_outer =
        8 + 2 + 12 * (outer.size() + 1) + 4 + (facts.camera.empty() ? 0 : facts.camera.size() + 1);
    outer.push_back({0x8769, offset, static_cast<std::uint32_t>(behind_outer), 0, {}});
    directory(outer);
    directory(inner);

    const auto length = static_cast<unsigned>(tiff.size() + 8);
    Bytes segment{0xff,
                  0xe1,
                  static_cast<std::uint8_t>(length >> 8),
                  static_cast<std::uint8_t>(length),
                  'E',
                  'x',
                  'i',
                  'f',
                  0,
                  0};
    segment.insert(segment.end(), tiff.begin(), tiff.end());
    return segment;
}

/// Saves the image as a JPEG file with this metadata.
inline void save_photograph(const std::filesystem::path& file, const Image& image,
                            const WrittenMetadata& facts, bool big_endian = false) {
    save_image(file, image);
    Bytes bytes = read_bytes(file);
    const Bytes segment = exif_segment(facts, big_endian);
    bytes.insert(bytes.begin() + 2, segment.begin(), segment.end());
    write_atomically(file, bytes);
}

}  // namespace item3d::testing
