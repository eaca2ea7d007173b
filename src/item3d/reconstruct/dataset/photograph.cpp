#include "item3d/reconstruct/dataset/photograph.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/io/load.h"
#include "item3d/reconstruct/dataset/camera_metadata.h"
#include "item3d/reconstruct/dataset/orientation.h"
#include "item3d/report/display_image.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

namespace fs = std::filesystem;

bool is_floating(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension == ".exr" || extension == ".hdr";
}

std::string size_text(int width, int height) {
    return fmt::format("{} x {}", width, height);
}

bool has_proportions(int width, int height, const Lens& lens) {
    return std::abs(static_cast<double>(width) * lens.height -
                    static_cast<double>(height) * lens.width) <= std::max(width, height);
}

/// Returns true if the poses belong to the images as shown, not as stored. The width and height of
/// the lens decide this. If the layout has no size, the result is true.
bool is_posed_as_shown(const Image& stored, int orientation, const Lens& lens) {
    if (lens.width == 0) return true;
    return swaps_sides(orientation) && !has_proportions(stored.width, stored.height, lens) &&
           has_proportions(stored.height, stored.width, lens);
}

/// Returns the lens scaled to the image, which may be smaller than the lens says (folders like
/// images_4) but must have its proportions.
Lens lens_for(const Image& image, const SourceView& view) {
    const Lens& lens = view.lens;
    if (lens.width > 0) {
        const double x = static_cast<double>(image.width) / lens.width;
        const double y = static_cast<double>(image.height) / lens.height;
        // Each side may be rounded by half a pixel.
        const double rounding = 0.51 / lens.width + 0.51 / lens.height;
        if (std::abs(x - y) > rounding) {
            throw InputError(view.image.string(),
                             "the image is " + size_text(image.width, image.height) +
                                 ", but its camera has " + size_text(lens.width, lens.height),
                             "use the images that the poses were estimated for");
        }
    }
    return lens.scaled_to(image.width, image.height);
}

bool varies(const Image& image, int channel) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (image.at(x, y, channel) < 0.999f) return true;
    return false;
}

bool is_proportional(const Image& mask, int width, int height) {
    return std::abs(static_cast<double>(mask.width) / width -
                    static_cast<double>(mask.height) / height) < 0.02;
}

/// Loads a mask as one channel. It is the alpha channel if the file has one that varies, otherwise
/// the mean of the colours. turn: EXIF orientation that is applied to a mask with other proportions
/// than its image.
Image load_mask(const fs::path& file, const Image& image, int turn) {
    Image stored = load_image(file);
    if (!is_proportional(stored, image.width, image.height)) {
        if (!swaps_sides(turn) || !is_proportional(stored, image.height, image.width)) {
            throw InputError(file.string(),
                             "the mask is " + size_text(stored.width, stored.height) +
                                 ", but its image is " + size_text(image.width, image.height),
                             "a mask must have the size of its image");
        }
        stored = oriented(stored, turn);
    }
    const bool has_alpha = stored.channels == 2 || stored.channels == 4;
    const bool from_alpha = has_alpha && varies(stored, stored.channels - 1);
    const int colors = has_alpha ? stored.channels - 1 : stored.channels;
    Image mask(stored.width, stored.height, 1);
    for (int y = 0; y < stored.height; ++y) {
        for (int x = 0; x < stored.width; ++x) {
            float sum = 0;
            for (int c = 0; c < colors; ++c)
                sum += stored.at(x, y, c);
            mask.at(x, y, 0) = std::clamp(from_alpha ? stored.at(x, y, stored.channels - 1)
                                                     : sum / static_cast<float>(colors),
                                          0.0f, 1.0f);
        }
    }
    return resize(mask, image.width, image.height);
}

float largest_difference(const Vec3& a, const Vec3& b) {
    const Vec3 difference = glm::abs(a - b);
    return std::max({difference.x, difference.y, difference.z});
}

Vec3 color_at(const Image& image, int x, int y) {
    Vec3 color;
    for (int c = 0; c < 3; ++c)
        color[c] = image.at(x, y, image.channels >= 3 ? c : 0);
    return color;
}

/// Returns linear RGB times coverage, and coverage.
Image premultiplied(const Image& image, const Image& mask, bool is_linear,
                    const std::optional<Vec3>& background, float tolerance) {
    Image result(image.width, image.height, 4);
    const bool has_alpha = image.channels == 2 || image.channels == 4;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const Vec3 color = color_at(image, x, y);
            float alpha = has_alpha ? image.at(x, y, image.channels - 1) : 1.0f;
            if (!mask.empty()) {
                alpha = mask.at(x, y, 0);
            } else if (background) {
                // Alpha rises gradually, because pixels at antialiased edges are partly background.
                alpha = std::clamp(largest_difference(color, *background) / tolerance - 0.5f, 0.0f,
                                   alpha);
            }
            alpha = std::isfinite(alpha) ? std::clamp(alpha, 0.0f, 1.0f) : 0.0f;
            for (int c = 0; c < 3; ++c) {
                const float value = std::isfinite(color[c]) ? std::max(color[c], 0.0f) : 0.0f;
                result.at(x, y, c) = alpha * (is_linear ? value : srgb_to_linear(value));
            }
            result.at(x, y, 3) = alpha;
        }
    }
    return result;
}

}  // namespace

fs::path find_mask(const fs::path& folder, const SourceView& view) {
    const std::string file = view.image.filename().string();
    const std::string base = fs::path(view.name).filename().string();
    for (const fs::path& name : {fs::path(view.name), fs::path(base), fs::path(file)}) {
        if (fs::is_regular_file(folder / name)) return folder / name;
        fs::path with = name;
        with += ".png";
        if (fs::is_regular_file(folder / with)) return folder / with;
    }
    return {};
}

std::optional<Vec3> plain_border_color(const Image& image, float tolerance) {
    constexpr double plain_share = 0.9, min_object = 0.002;
    std::vector<Vec3> border;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (x == 0 || y == 0 || x + 1 == image.width || y + 1 == image.height)
                border.push_back(color_at(image, x, y));
    Vec3 median;
    for (int c = 0; c < 3; ++c) {
        std::vector<float> values;
        for (const Vec3& color : border)
            values.push_back(color[c]);
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        median[c] = *middle;
    }
    const auto plain = std::count_if(border.begin(), border.end(), [&](const Vec3& color) {
        return largest_difference(color, median) <= 0.5f * tolerance;
    });
    if (static_cast<double>(plain) < plain_share * static_cast<double>(border.size())) return {};
    int other = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            other += largest_difference(color_at(image, x, y), median) > tolerance;
    if (other < min_object * image.width * image.height) return {};
    return median;
}

LoadedPhotograph load_photograph(const SourceView& view, const fs::path& mask_file,
                                 const DatasetOptions& options) {
    std::error_code ignored;
    if (!fs::is_regular_file(view.image, ignored)) {
        throw InputError(
            view.image.string(),
            fs::exists(view.image, ignored)
                ? "is not a file, but the image of view '" + view.name + "' should be here"
                : "the image of view '" + view.name + "' is missing",
            "every pose needs an image; use --images for the folder of the images of COLMAP and "
            "LLFF");
    }
    const CameraMetadata metadata = camera_metadata(view.image);
    Image image = load_image(view.image);
    const bool as_shown = is_posed_as_shown(image, metadata.orientation, view.lens);
    if (as_shown) image = oriented(image, metadata.orientation);
    const Lens lens = lens_for(image, view);

    LoadedPhotograph loaded;
    loaded.exposure = metadata.exposure;
    const bool has_alpha = image.channels == 2 || image.channels == 4;
    std::optional<Vec3> background = options.background;
    Image mask;
    if (!mask_file.empty()) {
        mask =
            load_mask(mask_file, image,
                      as_shown ? metadata.orientation : inverse_orientation(metadata.orientation));
        loaded.mask = MaskOrigin::folder;
    } else if (has_alpha && varies(image, image.channels - 1)) {
        loaded.mask = MaskOrigin::alpha;
    } else if (background) {
        loaded.mask = MaskOrigin::background;
    } else {
        background = plain_border_color(image, options.background_tolerance);
        loaded.mask = background ? MaskOrigin::plain_border : MaskOrigin::none;
    }
    loaded.image =
        undistort(premultiplied(image, mask, options.is_linear || is_floating(view.image),
                                background, options.background_tolerance),
                  lens);
    loaded.camera_to_world = view.camera_to_world;
    // If the pose belongs to the stored image, image and pose are rotated to the image as shown.
    if (!as_shown && is_turn(metadata.orientation)) {
        loaded.image = oriented(loaded.image, metadata.orientation);
        loaded.camera_to_world = oriented_camera(view.camera_to_world, metadata.orientation);
    }
    Lens& ideal = loaded.lens;
    ideal.width = loaded.image.width;
    ideal.height = loaded.image.height;
    ideal.focal_x = ideal.focal_y = lens.focal_x;
    ideal.centre_x = 0.5 * ideal.width;
    ideal.centre_y = 0.5 * ideal.height;
    if (options.longest_side > 0) {
        loaded.image = thumbnail(loaded.image, options.longest_side);
        ideal = ideal.scaled_to(loaded.image.width, loaded.image.height);
    }
    return loaded;
}

}  // namespace item3d
