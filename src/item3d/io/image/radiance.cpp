// Radiance images (Ward, "Real Pixels", Graphics Gems II): RGBE and XYZE, uncompressed or in the
// old or the new run-length coding, in all eight orientations. EXPOSURE and COLORCORR are undone.
#include "item3d/io/image/radiance.h"

#include "item3d/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

namespace item3d {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

struct RadianceHeader {
    int width = 0;
    int height = 0;
    bool columns_first = false;  ///< scanlines are columns ("+X 3 -Y 2")
    bool flip_x = false;         ///< right to left
    bool flip_y = false;         ///< bottom to top
    bool is_xyz = false;
    std::array<double, 3> scale{1, 1, 1};
    std::size_t data_offset = 0;
};

class RadianceReader {
  public:
    RadianceReader(std::span<const std::uint8_t> bytes, const std::string& subject)
        : bytes_(bytes), subject_(subject) {}

    RadianceHeader read_header() {
        RadianceHeader header;
        read_line();  // magic number
        for (std::string_view line = read_line(); !line.empty(); line = read_line()) {
            double values[3];
            const std::string text(line);
            if (line == "FORMAT=32-bit_rle_xyze") header.is_xyz = true;
            if (std::sscanf(text.c_str(), "EXPOSURE=%lf", values) == 1 && values[0] > 0 &&
                std::isfinite(values[0])) {
                for (double& scale : header.scale)
                    scale /= values[0];
            }
            if (std::sscanf(text.c_str(), "COLORCORR=%lf %lf %lf", values, values + 1,
                            values + 2) == 3) {
                for (int c = 0; c < 3; ++c) {
                    if (values[c] > 0 && std::isfinite(values[c])) header.scale[c] /= values[c];
                }
            }
        }
        const std::string resolution(read_line());
        char signs[2], axes[2];
        long long sizes[2];
        if (std::sscanf(resolution.c_str(), "%c%c %lld %c%c %lld", &signs[0], &axes[0], &sizes[0],
                        &signs[1], &axes[1], &sizes[1]) != 6 ||
            std::minmax(axes[0], axes[1]) != std::pair<const char&, const char&>('X', 'Y') ||
            sizes[0] <= 0 || sizes[1] <= 0) {
            throw InputError(subject_,
                             "expected a resolution such as '-Y 256 +X 512', found '" +
                                 resolution.substr(0, 60) + "'",
                             "export the image again");
        }
        header.columns_first = axes[0] == 'X';
        const int x = header.columns_first ? 0 : 1;
        header.flip_x = signs[x] == '-';
        header.flip_y = signs[1 - x] == '+';
        // Old run-length coding can encode any number of pixels in a few bytes; new run-length
        // coding can encode 127 values in two bytes.
        check_image_size(static_cast<std::uint64_t>(sizes[x]),
                         static_cast<std::uint64_t>(sizes[1 - x]), 3, bytes_.size(), 64, subject_);
        header.width = static_cast<int>(sizes[x]);
        header.height = static_cast<int>(sizes[1 - x]);
        return header;
    }

    void read_scanline(std::vector<Rgbe>& line) {
        const std::size_t width = line.size();
        const Rgbe first = read_pixel();
        const bool is_new = first[0] == 2 && first[1] == 2 && first[2] < 128 && width >= 8 &&
                            width < 32768 && (first[2] << 8 | first[3]) == static_cast<int>(width);
        if (is_new) {
            for (int c = 0; c < 4; ++c)
                read_component(line, c);
        } else {
            read_old_scanline(line, first);
        }
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(subject_, "the Radiance image cannot be decoded: " + problem,
                         "export it again");
    }

    std::string_view read_line() {
        const std::size_t begin = offset_;
        while (offset_ < bytes_.size() && bytes_[offset_] != '\n')
            ++offset_;
        if (offset_ == bytes_.size()) fail("the end of the header is missing");
        std::string_view line(reinterpret_cast<const char*>(bytes_.data()) + begin,
                              offset_ - begin);
        ++offset_;
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        return line;
    }

    std::uint8_t read_byte() {
        if (offset_ >= bytes_.size()) fail("the file ends too early");
        return bytes_[offset_++];
    }

    Rgbe read_pixel() {
        Rgbe pixel;
        for (std::uint8_t& value : pixel)
            value = read_byte();
        return pixel;
    }

    void read_component(std::vector<Rgbe>& line, int component) {
        for (std::size_t x = 0; x < line.size();) {
            std::size_t count = read_byte();
            const bool is_run = count > 128;
            if (is_run) count -= 128;
            if (count == 0 || count > line.size() - x) fail("a run exceeds its scanline");
            std::uint8_t value = is_run ? read_byte() : 0;
            for (; count > 0; --count) {
                if (!is_run) value = read_byte();
                line[x++][component] = value;
            }
        }
    }

    void read_old_scanline(std::vector<Rgbe>& line, Rgbe pixel) {
        int shift = 0;
        for (std::size_t x = 0;;) {
            if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
                const std::size_t count = static_cast<std::size_t>(pixel[3]) << shift;
                if (x == 0 || count > line.size() - x) fail("a run exceeds its scanline");
                std::fill_n(line.begin() + static_cast<std::ptrdiff_t>(x), count, line[x - 1]);
                x += count;
                shift = std::min(shift + 8, 24);
            } else {
                line[x++] = pixel;
                shift = 0;
            }
            if (x == line.size()) return;
            pixel = read_pixel();
        }
    }

    std::span<const std::uint8_t> bytes_;
    std::string subject_;
    std::size_t offset_ = 0;
};

std::array<float, 3> radiance_of(const Rgbe& pixel, const RadianceHeader& header) {
    if (pixel[3] == 0) return {0, 0, 0};
    const double unit = std::ldexp(1.0, pixel[3] - 136);
    std::array<double, 3> value{pixel[0] * unit, pixel[1] * unit, pixel[2] * unit};
    if (header.is_xyz) {
        const auto [x, y, z] = value;
        value = {3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
                 -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
                 0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
    }
    return {static_cast<float>(value[0] * header.scale[0]),
            static_cast<float>(value[1] * header.scale[1]),
            static_cast<float>(value[2] * header.scale[2])};
}

// Rounds to nearest (Radiance itself truncates, and adds half a step when it reads).
Rgbe to_rgbe(const float* rgb, int channels) {
    std::array<double, 3> value;
    for (int c = 0; c < 3; ++c) {
        const float v = rgb[channels < 3 ? 0 : c];
        value[c] = v > 0 ? std::min(static_cast<double>(v), 1e38) : 0.0;
    }
    const double largest = std::max({value[0], value[1], value[2]});
    if (largest < 1e-38) return {0, 0, 0, 0};
    int exponent;
    std::frexp(largest, &exponent);
    if (std::nearbyint(std::ldexp(largest, 8 - exponent)) > 255) ++exponent;
    Rgbe result;
    for (int c = 0; c < 3; ++c) {
        result[c] = static_cast<std::uint8_t>(std::nearbyint(std::ldexp(value[c], 8 - exponent)));
    }
    result[3] = static_cast<std::uint8_t>(std::clamp(exponent + 128, 1, 255));
    return result;
}

void write_component(Bytes& out, const std::vector<Rgbe>& line, int component) {
    const std::size_t width = line.size();
    const auto run_at = [&](std::size_t x) {
        std::size_t end = x + 1;
        while (end < width && end - x < 127 && line[end][component] == line[x][component])
            ++end;
        return end - x;
    };
    for (std::size_t x = 0; x < width;) {
        const std::size_t run = run_at(x);
        if (run >= 4) {
            out.push_back(static_cast<std::uint8_t>(128 + run));
            out.push_back(line[x][component]);
            x += run;
            continue;
        }
        std::size_t end = x;
        while (end < width && end - x < 128 && run_at(end) < 4)
            ++end;
        out.push_back(static_cast<std::uint8_t>(end - x));
        for (; x < end; ++x)
            out.push_back(line[x][component]);
    }
}

}  // namespace

DecodedImage decode_radiance(std::span<const std::uint8_t> bytes, const std::string& subject) {
    RadianceReader reader(bytes, subject);
    const RadianceHeader header = reader.read_header();
    const int lines = header.columns_first ? header.width : header.height;
    std::vector<Rgbe> line(
        static_cast<std::size_t>(header.columns_first ? header.height : header.width));
    DecodedImage result{Image(header.width, header.height, 3), 32};
    for (int i = 0; i < lines; ++i) {
        reader.read_scanline(line);
        for (std::size_t k = 0; k < line.size(); ++k) {
            int x = header.columns_first ? i : static_cast<int>(k);
            int y = header.columns_first ? static_cast<int>(k) : i;
            if (header.flip_x) x = header.width - 1 - x;
            if (header.flip_y) y = header.height - 1 - y;
            const auto rgb = radiance_of(line[k], header);
            for (int c = 0; c < 3; ++c)
                result.image.at(x, y, c) = rgb[c];
        }
    }
    return result;
}

Bytes encode_radiance(const Image& image) {
    ITEM3D_CHECK(image.width > 0 && image.height > 0 && image.channels >= 1,
                 "an empty image cannot be written");
    const std::string header = fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n",
                                           image.height, image.width);
    Bytes out(header.begin(), header.end());
    const bool run_lengths = image.width >= 8 && image.width < 32768;
    std::vector<Rgbe> line(static_cast<std::size_t>(image.width));
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            line[x] = to_rgbe(
                &image.pixels[(static_cast<std::size_t>(y) * image.width + x) * image.channels],
                image.channels);
        }
        if (!run_lengths) {
            for (const Rgbe& pixel : line)
                out.insert(out.end(), pixel.begin(), pixel.end());
            continue;
        }
        out.insert(out.end(), {2, 2, static_cast<std::uint8_t>(image.width >> 8),
                               static_cast<std::uint8_t>(image.width & 255)});
        for (int c = 0; c < 4; ++c)
            write_component(out, line, c);
    }
    return out;
}

}  // namespace item3d
