// Khronos KTX 2.0. Every offset is checked here, because the transcoder adds without checks for
// overflow.
#include "item3d/io/image/ktx2.h"

#include "item3d/core/error.h"

#include <fmt/format.h>
#include <transcoder/basisu_transcoder.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <mutex>
#include <vector>

namespace item3d {
namespace {

constexpr std::size_t ktx2_header_size = 80;

class Ktx2Header {
  public:
    Ktx2Header(std::span<const std::uint8_t> bytes, const std::string& subject)
        : bytes_(bytes), subject_(subject) {
        if (bytes.size() < ktx2_header_size) fail("it ends within its header");
    }

    std::uint32_t vulkan_format() const { return number<std::uint32_t>(12); }
    std::uint32_t width() const { return number<std::uint32_t>(20); }
    std::uint32_t height() const { return number<std::uint32_t>(24); }
    std::uint32_t supercompression() const { return number<std::uint32_t>(44); }
    std::uint64_t uncompressed_size() const { return number<std::uint64_t>(ktx2_header_size + 16); }

    /// Throws InputError where the file is not a two-dimensional image of Basis Universal, or
    /// refers to bytes beyond its end.
    void check() const {
        if (vulkan_format() != 0) {
            throw InputError(
                subject_,
                fmt::format("expected Basis Universal in the KTX2, found Vulkan format {}",
                            vulkan_format()),
                "convert it to PNG, JPEG or WebP");
        }
        if (supercompression() > 2) {
            throw InputError(subject_,
                             fmt::format("the KTX2 is compressed with the unknown scheme {}",
                                         supercompression()),
                             "use BasisLZ, Zstandard or none");
        }
        const std::uint64_t levels = number<std::uint32_t>(40);
        const std::uint64_t layers = std::max(number<std::uint32_t>(32), 1u);
        const std::uint64_t faces = number<std::uint32_t>(36);
        if (levels == 0 || levels > 32 || (faces != 1 && faces != 6)) fail("its header is damaged");
        check_range(ktx2_header_size, 24 * levels);
        for (std::uint64_t level = 0; level < levels; ++level) {
            const std::size_t at = ktx2_header_size + 24 * static_cast<std::size_t>(level);
            check_range(number<std::uint64_t>(at), number<std::uint64_t>(at + 8));
        }
        check_range(number<std::uint32_t>(48), number<std::uint32_t>(52));
        check_range(number<std::uint64_t>(64), number<std::uint64_t>(72));
        // The file has a descriptor of 20 bytes for each image.
        if (supercompression() == 1 && layers * faces * levels > bytes_.size() / 20)
            fail("its header is damaged");
    }

    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(subject_, "the KTX2 cannot be decoded: " + problem,
                         "the file is damaged; export it again");
    }

  private:
    template <typename T>
    T number(std::size_t offset) const {
        T value;
        std::memcpy(&value, bytes_.data() + offset, sizeof value);
        return value;
    }

    void check_range(std::uint64_t offset, std::uint64_t length) const {
        if (offset > bytes_.size() || length > bytes_.size() - offset)
            fail("it ends too early, or its header is damaged");
    }

    std::span<const std::uint8_t> bytes_;
    const std::string& subject_;
};

// Returns the number of channels with information: 3, or 4 with alpha.
int channels_of(const basist::ktx2_transcoder& transcoder) {
    return transcoder.get_has_alpha() ? 4 : 3;
}

}  // namespace

DecodedImage decode_ktx2(std::span<const std::uint8_t> bytes, const std::string& subject) {
    static std::once_flag tables;
    std::call_once(tables, basist::basisu_transcoder_init);
    const Ktx2Header header(bytes, subject);
    header.check();
    // Both codebooks and Zstandard can encode a block of 16 pixels in less than a bit.
    check_image_size(header.width(), header.height(), 4, bytes.size(), 1ull << 16, subject);
    const std::uint64_t blocks =
        ((header.width() + 3ull) / 4) * ((header.height() + 3ull) / 4) * 16;
    // Cube maps and arrays have a few images in each level.
    if (header.supercompression() == 2 && header.uncompressed_size() > 64 * blocks)
        header.fail("its header is damaged");
    if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) header.fail("it is too large");

    // The copy claims to have no keys and values, which are not needed here.
    std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
    std::fill_n(copy.begin() + 56, 8, std::uint8_t{0});
    basist::ktx2_transcoder transcoder;
    if (!transcoder.init(copy.data(), static_cast<std::uint32_t>(copy.size())))
        header.fail("it is neither ETC1S nor UASTC, or its header is damaged");
    if (!transcoder.start_transcoding()) header.fail("its codebooks are damaged");
    const int width = static_cast<int>(header.width());
    const int height = static_cast<int>(header.height());
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::vector<std::uint8_t> rgba(4 * pixels);
    if (!transcoder.transcode_image_level(0, 0, 0, rgba.data(), static_cast<std::uint32_t>(pixels),
                                          basist::transcoder_texture_format::cTFRGBA32))
        header.fail("its data are damaged");

    const int channels = channels_of(transcoder);
    DecodedImage result{Image(width, height, channels), 8, {}};
    // A changed copy is a JPEG, which every viewer reads.
    result.coding = {ImageEncoding::jpeg, false, 85};
    for (std::size_t i = 0; i < pixels; ++i) {
        for (int c = 0; c < channels; ++c) {
            result.image.pixels[i * static_cast<std::size_t>(channels) + c] =
                static_cast<float>(rgba[4 * i + static_cast<std::size_t>(c)]) / 255.0f;
        }
    }
    return result;
}

}  // namespace item3d
