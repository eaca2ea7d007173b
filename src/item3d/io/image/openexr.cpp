// OpenEXR, read and written in memory by its library.
#include "item3d/io/image/openexr.h"

#include "item3d/core/error.h"

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfVersion.h>

#include <algorithm>
#include <cstring>
#include <map>

namespace item3d {
namespace {

class MemoryInput : public Imf::IStream {
  public:
    MemoryInput(std::span<const std::uint8_t> bytes, const std::string& subject)
        : Imf::IStream(subject.c_str()), bytes_(bytes) {}

    bool read(char out[], int count) override {
        if (count < 0 || offset_ > bytes_.size() ||
            static_cast<std::size_t>(count) > bytes_.size() - offset_) {
            throw Iex::InputExc("the file ends too early");
        }
        std::memcpy(out, bytes_.data() + offset_, static_cast<std::size_t>(count));
        offset_ += static_cast<std::uint64_t>(count);
        return offset_ < bytes_.size();
    }
    std::uint64_t tellg() override { return offset_; }
    void seekg(std::uint64_t position) override { offset_ = position; }
    void clear() override {}

  private:
    std::span<const std::uint8_t> bytes_;
    std::uint64_t offset_ = 0;
};

class MemoryOutput : public Imf::OStream {
  public:
    MemoryOutput() : Imf::OStream("memory") {}

    void write(const char data[], int count) override {
        const std::size_t end = offset_ + static_cast<std::size_t>(count);
        if (bytes.size() < end) bytes.resize(end);
        std::memcpy(bytes.data() + offset_, data, static_cast<std::size_t>(count));
        offset_ = end;
    }
    std::uint64_t tellp() override { return offset_; }
    void seekp(std::uint64_t position) override { offset_ = position; }

    Bytes bytes;

  private:
    std::uint64_t offset_ = 0;
};

struct Window {
    std::int64_t left, top, width, height;

    explicit Window(const Imath::Box2i& box)
        : left(box.min.x),
          top(box.min.y),
          width(static_cast<std::int64_t>(box.max.x) - box.min.x + 1),
          height(static_cast<std::int64_t>(box.max.y) - box.min.y + 1) {}
};

// Validation of attributes. The library allocates attributes by their declared sizes before it
// reads them, and reads some types regardless of the declared size. Therefore each attribute must
// lie in the file and have its type's size.
class AttributeWalk {
  public:
    AttributeWalk(std::span<const std::uint8_t> bytes, const std::string& subject)
        : bytes_(bytes), subject_(subject) {}

    void check(bool several_parts) {
        for (bool is_first = true;; is_first = false) {
            std::string_view name = read_name();
            if (name.empty() && !is_first) return;  // the list of headers ends here
            for (; !name.empty(); name = read_name())
                check_attribute();
            if (!several_parts) return;
        }
    }

  private:
    [[noreturn]] void fail() const {
        throw InputError(subject_, "the OpenEXR header is damaged or cut short", "export it again");
    }

    std::string_view read_name() {
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && bytes_[at_] != 0)
            ++at_;
        if (at_ == bytes_.size()) fail();
        ++at_;
        return {reinterpret_cast<const char*>(bytes_.data()) + begin, at_ - 1 - begin};
    }

    std::uint32_t read_word() {
        if (bytes_.size() - at_ < 4) fail();
        std::uint32_t word;
        std::memcpy(&word, bytes_.data() + at_, 4);
        at_ += 4;
        return word;
    }

    void check_attribute() {
        const std::string type(read_name());
        const std::size_t size = read_word();
        if (size > bytes_.size() - at_) fail();
        const std::size_t end = at_ + size;
        const auto fixed = fixed_sizes().find(type);
        if (fixed != fixed_sizes().end() && size != fixed->second) fail();
        if (type == "chlist") {
            // The list contains each channel's name and 16 bytes, and ends with an empty name.
            while (!read_name().empty()) {
                if (at_ > end || end - at_ < 17) fail();
                at_ += 16;
            }
            if (at_ != end) fail();
        } else if (type == "stringvector") {
            while (at_ < end) {
                const std::size_t length = read_word();
                if (at_ > end || length > end - at_) fail();
                at_ += length;
            }
        } else if (type == "preview") {
            const std::uint64_t width = read_word();
            const std::uint64_t height = read_word();
            if (width > size || height > size || 8 + 4 * width * height != size) fail();
        }
        at_ = end;
    }

    static const std::map<std::string, std::size_t>& fixed_sizes() {
        static const std::map<std::string, std::size_t> sizes{
            {"box2f", 16},
            {"box2i", 16},
            {"chromaticities", 32},
            {"compression", 1},
            {"double", 8},
            {"envmap", 1},
            {"deepImageState", 1},
            {"float", 4},
            {"int", 4},
            {"m33d", 72},
            {"m33f", 36},
            {"m44d", 128},
            {"m44f", 64},
            {"v2d", 16},
            {"v2f", 8},
            {"v2i", 8},
            {"v3d", 24},
            {"v3f", 12},
            {"v3i", 12},
            {"keycode", 28},
            {"rational", 8},
            {"tiledesc", 9},
            {"timecode", 8},
            {"lineOrder", 1},
        };
        return sizes;
    }

    std::span<const std::uint8_t> bytes_;
    std::string subject_;
    std::size_t at_ = 8;
};

// Checks the headers before InputFile reads them, because InputFile allocates tables by their
// values.
void check_headers(std::span<const std::uint8_t> bytes, const std::string& subject) {
    MemoryInput stream(bytes, subject);
    char words[8];
    stream.read(words, 8);
    std::uint32_t version;
    std::memcpy(&version, words + 4, 4);
    const bool several_parts = Imf::isMultiPart(static_cast<int>(version));
    AttributeWalk(bytes, subject).check(several_parts);
    do {
        Imf::Header header;
        int header_version = static_cast<int>(version);
        header.readFrom(stream, header_version);
        const Window data(header.dataWindow());
        if (data.width <= 0 || data.height <= 0) {
            throw InputError(subject, "the OpenEXR data window is empty", "export it again");
        }
        check_image_size(static_cast<std::uint64_t>(data.width),
                         static_cast<std::uint64_t>(data.height), 1, bytes.size(), 1032, subject);
        if (header.hasTileDescription()) {
            const Imf::TileDescription& tiles = header.tileDescription();
            check_image_size(tiles.xSize, tiles.ySize, 1, bytes.size(), 1032 * 16, subject);
        }
        if (header.hasType() && Imf::isDeepData(header.type())) {
            throw InputError(subject, "deep OpenEXR data is not supported", "export a flat image");
        }
        if (!several_parts) return;
        char next;
        stream.read(&next, 1);
        if (next == 0) return;
        stream.seekg(stream.tellg() - 1);
    } while (true);
}

// Returns the names of the image's channels: R G B (A), or else Y (A), or else these channels of
// the first layer that has them, or else the only channel.
std::vector<std::string> choose_channels(const Imf::ChannelList& channels,
                                         const std::string& subject) {
    std::vector<std::string> names;
    for (auto it = channels.begin(); it != channels.end(); ++it)
        names.emplace_back(it.name());
    const auto has = [&](const std::string& name) { return channels.findChannel(name) != nullptr; };
    std::vector<std::string> prefixes{""};
    for (const std::string& name : names) {
        const std::size_t dot = name.rfind('.');
        if (dot != std::string::npos) prefixes.push_back(name.substr(0, dot + 1));
    }
    for (const std::string& prefix : prefixes) {
        std::vector<std::string> chosen;
        if (has(prefix + "R") && has(prefix + "G") && has(prefix + "B")) {
            chosen = {prefix + "R", prefix + "G", prefix + "B"};
        } else if (has(prefix + "X") && has(prefix + "Y") && has(prefix + "Z")) {
            chosen = {prefix + "X", prefix + "Y", prefix + "Z"};
        } else if (has(prefix + "Y")) {
            chosen = {prefix + "Y"};
        }
        if (chosen.empty()) continue;
        if (has(prefix + "A")) chosen.push_back(prefix + "A");
        return chosen;
    }
    if (names.size() == 1) return names;
    std::string list;
    for (const std::string& name : names)
        list += (list.empty() ? "" : ", ") + name;
    throw InputError(subject, "expected the OpenEXR channels R, G, B or Y, found " + list,
                     "export the colour channels");
}

// Returns the display window (the image as framed) if its size is plausible, else the data window.
Window image_window(const Window& data, const Window& display) {
    const bool sane = display.width > 0 && display.height > 0 && display.width <= 4 * data.width &&
                      display.height <= 4 * data.height && display.left < data.left + data.width &&
                      data.left < display.left + display.width &&
                      display.top < data.top + data.height &&
                      data.top < display.top + display.height;
    return sane ? display : data;
}

void copy_window(const std::vector<float>& from, const Window& data, const Window& window,
                 int channel, Image& image) {
    const std::int64_t x0 = std::max(data.left, window.left);
    const std::int64_t x1 = std::min(data.left + data.width, window.left + window.width);
    const std::int64_t y0 = std::max(data.top, window.top);
    const std::int64_t y1 = std::min(data.top + data.height, window.top + window.height);
    for (std::int64_t y = y0; y < y1; ++y) {
        for (std::int64_t x = x0; x < x1; ++x) {
            image.at(static_cast<int>(x - window.left), static_cast<int>(y - window.top), channel) =
                from[static_cast<std::size_t>((y - data.top) * data.width + (x - data.left))];
        }
    }
}

DecodedImage read_luminance_chroma(std::span<const std::uint8_t> bytes, const std::string& subject,
                                   const Window& data, const Window& window) {
    MemoryInput stream(bytes, subject);
    Imf::RgbaInputFile file(stream);
    std::vector<Imf::Rgba> pixels(static_cast<std::size_t>(data.width * data.height));
    const auto base =
        reinterpret_cast<std::uintptr_t>(pixels.data()) -
        static_cast<std::uintptr_t>(data.left + data.top * data.width) * sizeof(Imf::Rgba);
    file.setFrameBuffer(reinterpret_cast<Imf::Rgba*>(base), 1,
                        static_cast<std::size_t>(data.width));
    file.readPixels(static_cast<int>(data.top), static_cast<int>(data.top + data.height - 1));
    DecodedImage result{Image(static_cast<int>(window.width), static_cast<int>(window.height), 3),
                        16};
    std::vector<float> plane(pixels.size());
    for (int c = 0; c < 3; ++c) {
        std::transform(pixels.begin(), pixels.end(), plane.begin(), [c](const Imf::Rgba& pixel) {
            return static_cast<float>(c == 0 ? pixel.r : c == 1 ? pixel.g : pixel.b);
        });
        copy_window(plane, data, window, c, result.image);
    }
    return result;
}

DecodedImage read_openexr(std::span<const std::uint8_t> bytes, const std::string& subject) {
    check_headers(bytes, subject);
    MemoryInput stream(bytes, subject);
    Imf::InputFile file(stream);
    const Imf::Header& header = file.header();
    const Window data(header.dataWindow());
    const Window window = image_window(data, Window(header.displayWindow()));
    const std::vector<std::string> names = choose_channels(header.channels(), subject);
    const auto count = static_cast<int>(names.size());
    check_image_size(static_cast<std::uint64_t>(window.width),
                     static_cast<std::uint64_t>(window.height), static_cast<std::uint64_t>(count),
                     bytes.size(), 1032 * 16, subject);
    if (header.channels().findChannel("RY") && header.channels().findChannel("BY")) {
        return read_luminance_chroma(bytes, subject, data, window);
    }

    std::vector<std::vector<float>> planes(names.size());
    Imf::FrameBuffer frame;
    bool all_half = true;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const Imf::Channel& channel = *header.channels().findChannel(names[i]);
        if (channel.xSampling != 1 || channel.ySampling != 1) {
            throw InputError(subject, "the OpenEXR channel " + names[i] + " is subsampled",
                             "export it at full resolution");
        }
        all_half = all_half && channel.type == Imf::HALF;
        planes[i].resize(static_cast<std::size_t>(data.width * data.height));
        // A slice's base is the address of pixel (0, 0), even if that pixel is outside of the data
        // window.
        const auto base =
            reinterpret_cast<std::uintptr_t>(planes[i].data()) -
            static_cast<std::uintptr_t>(data.left + data.top * data.width) * sizeof(float);
        frame.insert(names[i], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(base), sizeof(float),
                                          sizeof(float) * static_cast<std::size_t>(data.width)));
    }
    file.setFrameBuffer(frame);
    file.readPixels(static_cast<int>(data.top), static_cast<int>(data.top + data.height - 1));

    DecodedImage result{
        Image(static_cast<int>(window.width), static_cast<int>(window.height), count),
        all_half ? 16 : 32};
    for (int c = 0; c < count; ++c)
        copy_window(planes[c], data, window, c, result.image);
    return result;
}

}  // namespace

DecodedImage decode_openexr(std::span<const std::uint8_t> bytes, const std::string& subject) {
    try {
        return read_openexr(bytes, subject);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw ResourceError(subject + ": not enough memory to read it");
    } catch (const std::exception& error) {
        std::string problem = error.what();
        std::replace(problem.begin(), problem.end(), '\n', ' ');
        throw InputError(subject, "the OpenEXR image cannot be decoded: " + problem,
                         "export it again");
    }
}

Bytes encode_openexr(const Image& image, int bits_per_channel) {
    ITEM3D_CHECK(image.width > 0 && image.height > 0, "an empty image cannot be written");
    ITEM3D_CHECK(image.channels >= 1 && image.channels <= 4,
                 "1 to 4 channels can be written, not " + std::to_string(image.channels));
    const bool use_half = bits_per_channel == 16;
    const Imf::PixelType type = use_half ? Imf::HALF : Imf::FLOAT;
    static const char* const color_names[] = {"R", "G", "B", "A"};
    static const char* const gray_names[] = {"Y", "A"};
    const char* const* names = image.channels < 3 ? gray_names : color_names;

    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    std::vector<half> halves;
    if (use_half) halves.assign(image.pixels.begin(), image.pixels.end());
    const std::size_t value_size = use_half ? sizeof(half) : sizeof(float);
    const char* values = use_half ? reinterpret_cast<const char*>(halves.data())
                                  : reinterpret_cast<const char*>(image.pixels.data());
    Imf::FrameBuffer frame;
    for (int c = 0; c < image.channels; ++c) {
        header.channels().insert(names[c], Imf::Channel(type));
        // Imf::Slice also serves for reading, so it takes a non-const pointer.
        frame.insert(
            names[c],
            Imf::Slice(type, const_cast<char*>(values) + value_size * static_cast<std::size_t>(c),
                       value_size * static_cast<std::size_t>(image.channels),
                       value_size * static_cast<std::size_t>(image.channels) *
                           static_cast<std::size_t>(image.width)));
    }
    MemoryOutput stream;
    {
        Imf::OutputFile file(stream, header);
        file.setFrameBuffer(frame);
        file.writePixels(image.height);
    }
    return std::move(stream.bytes);
}

}  // namespace item3d
