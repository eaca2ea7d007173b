#include "item3d/reconstruct/dataset/pose_images.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/reconstruct/dataset/source.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <string>
#include <tuple>

namespace item3d {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t fewest_images = 3;

/// Returns the number of files in telephones' formats HEIC, HEIF and DNG.
std::size_t count_heic(const fs::path& folder) {
    std::size_t count = 0;
    std::error_code code;
    for (fs::directory_iterator i(folder, code), end; !code && i != end; i.increment(code)) {
        std::string extension = i->path().extension().string();
        for (char& c : extension)
            c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        count += extension == ".heic" || extension == ".heif" || extension == ".dng";
    }
    return count;
}

/// Properties that all images of one lens share, up to rounding.
using LensKey = std::tuple<ImageSize, std::string, int>;

LensKey key_of(const ImageSize& size, const CameraMetadata& metadata) {
    const double focal = metadata.focal_35 > 0 ? metadata.focal_35 : 100 * metadata.focal;
    return {size, metadata.camera, static_cast<int>(focal + 0.5)};
}

}  // namespace

PoseImages find_pose_images(const fs::path& folder) {
    if (!fs::is_directory(folder))
        throw InputError(folder.string(), "is not a folder of images",
                         "give a folder of photographs");
    PoseImages images;
    std::map<LensKey, std::size_t> lenses;
    for (const fs::path& file : list_images(folder)) {
        if (!fs::is_regular_file(file)) continue;
        const Bytes bytes = read_bytes(file);
        const std::optional<ImageSize> size = stored_size(bytes);
        if (!size) {
            warn(file.string() + ": is not a PNG or JPEG image and is left out");
            continue;
        }
        images.files.push_back(file);
        const CameraMetadata metadata = camera_metadata(bytes);
        const auto [place, is_new] = lenses.emplace(key_of(*size, metadata), lenses.size());
        if (is_new) {
            images.lenses.push_back(
                {*size, focal_in_pixels(metadata, size->width, size->height), {}});
        }
        images.lenses[place->second].files.push_back(file);
    }
    const std::size_t heic = count_heic(folder);
    const std::string convert =
        "convert them to JPEG first (heif-convert of libheif-examples, or the export of the phone)";
    if (images.files.size() < fewest_images) {
        throw InputError(
            folder.string(), fmt::format("contains {} PNG or JPEG image(s)", images.files.size()),
            heic > 0 ? fmt::format("it contains {} HEIC or DNG images: {}", heic, convert)
                     : "at least 3 are required, 30 or more are recommended");
    }
    if (heic > 0)
        warn(fmt::format("{}: {} HEIC or DNG images are left out: {}", folder.string(), heic,
                         convert));
    return images;
}

}  // namespace item3d
