#include "item3d/reconstruct/dataset/transforms.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/reconstruct/dataset/camera_metadata.h"
#include "item3d/reconstruct/dataset/orientation.h"
#include "item3d/scene/pose.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace item3d {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json read_transforms(const fs::path& file) {
    Json document = parse_json_text(read_text(file), file.string());
    if (!document.is_object() || !document.contains("frames") || !document["frames"].is_array()) {
        throw InputError(file.string(), "expected an object with a list \"frames\"",
                         "as in files of NeRF-synthetic and nerfstudio");
    }
    return document;
}

/// Numbers of a frame. If a frame lacks a number, the file's number for all frames is used.
class Numbers {
  public:
    Numbers(const Json& frame, const Json& document, std::string subject)
        : frame_(frame), document_(document), subject_(std::move(subject)) {}

    bool has(const char* key) const { return frame_.contains(key) || document_.contains(key); }
    double get(const char* key, double otherwise = 0) const {
        if (!has(key)) return otherwise;
        return finite_json_number(frame_.contains(key) ? frame_[key] : document_[key], subject_,
                                  key);
    }
    /// Returns a flag, stored as true or false (instant-ngp) or as a number, where 0 is false
    /// (other programs).
    bool flag(const char* key) const {
        if (!has(key)) return false;
        const Json& value = frame_.contains(key) ? frame_[key] : document_[key];
        return value.is_boolean() ? value.get<bool>() : get(key) != 0;
    }
    std::string text(const char* key) const {
        const Json& holder = frame_.contains(key) ? frame_ : document_;
        return holder.contains(key) && holder[key].is_string() ? holder[key].get<std::string>()
                                                               : "";
    }
    const std::string& subject() const { return subject_; }

  private:
    const Json& frame_;
    const Json& document_;
    std::string subject_;
};

int size_of(const Numbers& numbers, const char* key) {
    const double size = numbers.get(key);
    if (size < 0 || size > 65536 || size != std::floor(size)) {
        throw InputError(numbers.subject(),
                         fmt::format("{} is {}, which is not an image size", key, size),
                         "correct this number");
    }
    return static_cast<int>(size);
}

void read_distortion(const Numbers& numbers, Lens& lens) {
    const std::string model = numbers.text("camera_model");
    static const std::set<std::string> known{"",       "PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL",
                                             "RADIAL", "OPENCV",  "OPENCV_FISHEYE", "FULL_OPENCV"};
    if (known.count(model) == 0) {
        throw InputError(numbers.subject(), "camera_model '" + model + "' is not supported",
                         "undistort the images, or export the cameras as OPENCV or PINHOLE");
    }
    lens.fisheye = model == "OPENCV_FISHEYE" || numbers.flag("is_fisheye");
    const std::array keys{"k1", "k2", "k3", "k4", "k5", "k6"};
    for (std::size_t i = 0; i < keys.size(); ++i)
        lens.radial[i] = numbers.get(keys[i]);
    // In OpenCV's models k4 occurs only together with k5 and k6, as a rational model. nerfstudio
    // writes 0 for k4.
    lens.tangential = {numbers.get("p1"), numbers.get("p2")};
}

/// Returns the lens from an image's EXIF, for the image as shown. Returns nullopt if EXIF has no
/// focal length or the image is missing.
std::optional<Lens> lens_of_exif(const fs::path& image) {
    std::error_code ignored;
    if (!fs::is_regular_file(image, ignored)) return std::nullopt;
    const Bytes bytes = read_bytes(image);
    const std::optional<ImageSize> size = stored_size(bytes);
    if (!size) return std::nullopt;
    const CameraMetadata metadata = camera_metadata(bytes);
    Lens lens;
    lens.width = size->width;
    lens.height = size->height;
    if (swaps_sides(metadata.orientation)) std::swap(lens.width, lens.height);
    lens.focal_x = lens.focal_y = focal_in_pixels(metadata, lens.width, lens.height);
    lens.centre_x = 0.5 * lens.width;
    lens.centre_y = 0.5 * lens.height;
    return lens.focal_x > 0 ? std::optional(lens) : std::nullopt;
}

Lens read_lens(const Numbers& numbers, const fs::path& image, std::size_t& from_exif) {
    Lens lens;
    if (numbers.has("fl_x") && numbers.has("w") && numbers.has("h")) {
        lens.width = size_of(numbers, "w");
        lens.height = size_of(numbers, "h");
        lens.focal_x = numbers.get("fl_x");
        lens.focal_y = numbers.get("fl_y", lens.focal_x);
        lens.centre_x = numbers.get("cx", 0.5 * lens.width);
        lens.centre_y = numbers.get("cy", 0.5 * lens.height);
        read_distortion(numbers, lens);
    } else if (numbers.has("camera_angle_x")) {
        const double angle = numbers.get("camera_angle_x");
        if (!(angle > 1e-3 && angle < 3.1)) {
            throw InputError(numbers.subject(),
                             fmt::format("camera_angle_x must be between 0.001 and 3.1 radians, "
                                         "found {:.6g}",
                                         angle),
                             "camera_angle_x is in radians");
        }
        lens.focal_x = lens.focal_y = 0.5 / std::tan(0.5 * angle);
    } else if (const std::optional<Lens> found = lens_of_exif(image)) {
        lens = *found;
        read_distortion(numbers, lens);
        ++from_exif;
    } else {
        throw InputError(numbers.subject(),
                         "neither camera_angle_x nor fl_x, w and h are given, and there is no EXIF "
                         "focal length in " +
                             image.filename().string(),
                         "add the lens to the file, or estimate it with --from-images");
    }
    if (!(lens.focal_x > 0 && lens.focal_y > 0)) {
        throw InputError(numbers.subject(), "the focal length is not above 0",
                         "correct fl_x or camera_angle_x");
    }
    return lens;
}

void read_frames(const fs::path& file, Split split, SourceDataset& dataset) {
    const Json document = read_transforms(file);
    const fs::path folder = file.parent_path();
    for (std::size_t i = 0; i < document["frames"].size(); ++i) {
        const Json& frame = document["frames"][i];
        const std::string subject = fmt::format("{}: frame {}", file.string(), i);
        if (!frame.is_object() || !frame.contains("transform_matrix") ||
            !frame.contains("file_path") || !frame["file_path"].is_string()) {
            throw InputError(subject, "expected an object with file_path and transform_matrix",
                             "use a transforms.json in the NeRF-synthetic format");
        }
        SourceView view;
        const auto name = frame["file_path"].get<std::string>();
        view.name = without_image_extension(name);
        view.image = find_image(inside(folder, name, subject));
        view.camera_to_world = pose_from_rows(frame["transform_matrix"], subject);
        view.lens =
            read_lens(Numbers(frame, document, subject), view.image, dataset.lenses_of_exif);
        if (frame.contains("mask_path") && frame["mask_path"].is_string()) {
            view.mask = inside(folder, frame["mask_path"].get<std::string>(), subject);
        }
        view.split = split;
        dataset.views.push_back(std::move(view));
    }
}

std::set<std::string> names_in(const Json& document, const char* key) {
    std::set<std::string> names;
    if (document.contains(key) && document[key].is_array()) {
        for (const Json& name : document[key])
            if (name.is_string()) names.insert(without_image_extension(name.get<std::string>()));
    }
    return names;
}

}  // namespace

SourceDataset read_nerf_synthetic(const fs::path& folder) {
    SourceDataset dataset;
    dataset.kind = DatasetKind::nerf_synthetic;
    dataset.up = Vec3(0, 0, 1);
    read_frames(folder / "transforms_train.json", Split::train, dataset);
    // Some programs write files of cameras without images, such as the path of a film. Such a file
    // is skipped if the other file of held-out views has images.
    std::optional<SourceDataset> cameras_alone;
    for (const char* held_out : {"transforms_test.json", "transforms_val.json"}) {
        if (!fs::exists(folder / held_out)) continue;
        SourceDataset views;
        read_frames(folder / held_out, Split::test, views);
        const bool any_image =
            std::any_of(views.views.begin(), views.views.end(), [](const SourceView& view) {
                std::error_code code;
                return fs::is_regular_file(view.image, code);
            });
        if (!any_image && !views.views.empty()) {
            if (!cameras_alone) cameras_alone = std::move(views);
            continue;
        }
        cameras_alone.reset();
        dataset.views.insert(dataset.views.end(), views.views.begin(), views.views.end());
        break;
    }
    if (cameras_alone) {
        dataset.views.insert(dataset.views.end(), cameras_alone->views.begin(),
                             cameras_alone->views.end());
    }
    return dataset;
}

SourceDataset read_nerfstudio(const fs::path& file) {
    SourceDataset dataset;
    dataset.kind = DatasetKind::nerfstudio;
    read_frames(file, Split::unknown, dataset);
    const Json document = read_transforms(file);
    const auto train = names_in(document, "train_filenames");
    auto test = names_in(document, "test_filenames");
    test.merge(names_in(document, "val_filenames"));
    if (train.empty()) return dataset;
    for (SourceView& view : dataset.views) {
        if (test.count(view.name) > 0) view.split = Split::test;
        if (train.count(view.name) > 0) view.split = Split::train;
    }
    std::erase_if(dataset.views, [](const SourceView& v) { return v.split == Split::unknown; });
    return dataset;
}

}  // namespace item3d
