#include "item3d/reconstruct/dataset/camera_metadata.h"

#include <libexif/exif-data.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>

namespace item3d {

namespace {

/// Diagonal of 36 mm x 24 mm film in millimetres.
constexpr double film_diagonal = 43.266615;
constexpr double longest_focal = 10000, longest_exposure = 1e5;
/// Number of bytes to read. EXIF's segment has at most 64 KiB, and other segments may precede it.
constexpr std::size_t beginning = 1 << 18;
/// Maximum difference of proportions that rounding explains.
constexpr double same_proportions = 0.01;

class ExifReader {
  public:
    explicit ExifReader(const Bytes& file)
        : data_(exif_data_new_from_data(file.data(), static_cast<unsigned int>(file.size())),
                &exif_data_unref) {}

    explicit operator bool() const { return data_ != nullptr; }

    /// Returns the first value of a number, or 0 if the value is missing or not finite.
    double number(ExifIfd ifd, ExifTag tag) const {
        const ExifEntry* entry = find(ifd, tag);
        if (entry == nullptr || entry->components < 1 ||
            entry->size < exif_format_get_size(entry->format))
            return 0;
        const ExifByteOrder order = exif_data_get_byte_order(data_.get());
        switch (entry->format) {
            case EXIF_FORMAT_SHORT:
                return exif_get_short(entry->data, order);
            case EXIF_FORMAT_LONG:
                return exif_get_long(entry->data, order);
            case EXIF_FORMAT_RATIONAL: {
                const ExifRational value = exif_get_rational(entry->data, order);
                return value.denominator == 0
                           ? 0
                           : static_cast<double>(value.numerator) / value.denominator;
            }
            case EXIF_FORMAT_SRATIONAL: {
                const ExifSRational value = exif_get_srational(entry->data, order);
                return value.denominator == 0
                           ? 0
                           : static_cast<double>(value.numerator) / value.denominator;
            }
            default:
                return 0;
        }
    }
    bool has(ExifIfd ifd, ExifTag tag) const { return find(ifd, tag) != nullptr; }

    std::string text(ExifIfd ifd, ExifTag tag) const {
        const ExifEntry* entry = find(ifd, tag);
        if (entry == nullptr || entry->format != EXIF_FORMAT_ASCII) return {};
        const auto* begin = reinterpret_cast<const char*>(entry->data);
        return {begin, std::find(begin, begin + entry->size, '\0')};
    }

  private:
    const ExifEntry* find(ExifIfd ifd, ExifTag tag) const {
        return exif_content_get_entry(data_->ifd[ifd], tag);
    }

    std::unique_ptr<ExifData, decltype(&exif_data_unref)> data_;
};

double within(double value, double largest) {
    return std::isfinite(value) && value > 0 && value <= largest ? value : 0.0;
}

/// Returns the exposure from plain numbers or, if these are missing, from APEX logarithms.
double exposure_of(const ExifReader& exif) {
    double time = exif.number(EXIF_IFD_EXIF, EXIF_TAG_EXPOSURE_TIME);
    if (time <= 0 && exif.has(EXIF_IFD_EXIF, EXIF_TAG_SHUTTER_SPEED_VALUE))
        time = std::exp2(-exif.number(EXIF_IFD_EXIF, EXIF_TAG_SHUTTER_SPEED_VALUE));
    double aperture = exif.number(EXIF_IFD_EXIF, EXIF_TAG_FNUMBER);
    if (aperture <= 0 && exif.has(EXIF_IFD_EXIF, EXIF_TAG_APERTURE_VALUE))
        aperture = std::exp2(0.5 * exif.number(EXIF_IFD_EXIF, EXIF_TAG_APERTURE_VALUE));
    const double sensitivity = exif.number(EXIF_IFD_EXIF, EXIF_TAG_ISO_SPEED_RATINGS) / 100;
    // A camera reports aperture 0 for a lens without contacts. Its aperture counts as equal in all
    // images.
    const double square = aperture > 0 ? aperture * aperture : 1.0;
    return within(time * sensitivity / square, longest_exposure);
}

unsigned big_endian(const Bytes& bytes, std::size_t at, int count) {
    unsigned value = 0;
    for (int i = 0; i < count; ++i)
        value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
    return value;
}

ImageSize size_from(unsigned width, unsigned height) {
    return {static_cast<int>(std::min(width, 1u << 24)),
            static_cast<int>(std::min(height, 1u << 24))};
}

}  // namespace

CameraMetadata camera_metadata(const Bytes& file) {
    CameraMetadata metadata;
    const ExifReader exif(file);
    if (!exif) return metadata;
    const double orientation = exif.number(EXIF_IFD_0, EXIF_TAG_ORIENTATION);
    if (orientation >= 1 && orientation <= 8) metadata.orientation = static_cast<int>(orientation);
    metadata.focal_35 =
        within(exif.number(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM), longest_focal);
    metadata.focal = within(exif.number(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH), longest_focal);
    metadata.exposure = exposure_of(exif);
    for (const std::string& part :
         {exif.text(EXIF_IFD_0, EXIF_TAG_MAKE), exif.text(EXIF_IFD_0, EXIF_TAG_MODEL),
          exif.text(EXIF_IFD_EXIF, EXIF_TAG_LENS_MODEL)})
        metadata.camera += (metadata.camera.empty() || part.empty() ? "" : " ") + part;
    metadata.width =
        static_cast<int>(within(exif.number(EXIF_IFD_EXIF, EXIF_TAG_PIXEL_X_DIMENSION), 1 << 24));
    metadata.height =
        static_cast<int>(within(exif.number(EXIF_IFD_EXIF, EXIF_TAG_PIXEL_Y_DIMENSION), 1 << 24));
    return metadata;
}

CameraMetadata camera_metadata(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    Bytes bytes(beginning);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, stream.gcount())));
    return camera_metadata(bytes);
}

double focal_in_pixels(const CameraMetadata& metadata, int width, int height) {
    if (metadata.focal_35 <= 0 || width <= 0 || height <= 0) return 0;
    if (metadata.width > 0 && metadata.height > 0) {
        const auto longer = [](double a, double b) { return std::max(a, b) / std::min(a, b); };
        const double quotient = longer(metadata.width, metadata.height) / longer(width, height);
        if (std::abs(quotient - 1) > same_proportions) return 0;
    }
    return metadata.focal_35 / film_diagonal * std::hypot(width, height);
}

std::optional<ImageSize> stored_size(const Bytes& file) {
    constexpr std::array<std::uint8_t, 8> png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    if (file.size() >= 24 && std::equal(png.begin(), png.end(), file.begin()))
        return size_from(big_endian(file, 16, 4), big_endian(file, 20, 4));
    if (file.size() < 4 || big_endian(file, 0, 2) != 0xffd8) return std::nullopt;
    for (std::size_t at = 2; at + 9 < file.size() && file[at] == 0xff;) {
        const unsigned marker = file[at + 1];
        const bool is_frame =
            marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        if (is_frame) return size_from(big_endian(file, at + 7, 2), big_endian(file, at + 5, 2));
        at += marker == 0xff ? 1 : 2 + big_endian(file, at + 2, 2);
    }
    return std::nullopt;
}

}  // namespace item3d
