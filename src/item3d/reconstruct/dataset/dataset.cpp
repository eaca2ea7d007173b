#include "item3d/reconstruct/dataset/dataset.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/reconstruct/dataset/colmap.h"
#include "item3d/reconstruct/dataset/llff.h"
#include "item3d/reconstruct/dataset/orient_world.h"
#include "item3d/reconstruct/dataset/photograph.h"
#include "item3d/reconstruct/dataset/transforms.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace item3d {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t fewest_views = 3;

/// Returns the COLMAP model with the most images in a folder. COLMAP writes several models if it
/// cannot connect all images.
fs::path largest_colmap_model(const fs::path& folder) {
    std::vector<std::pair<std::size_t, fs::path>> models;
    std::error_code code;
    for (fs::directory_iterator i(folder, code), end; !code && i != end; i.increment(code)) {
        if (is_colmap_model(i->path()))
            models.emplace_back(count_colmap_images(i->path()), i->path());
    }
    if (models.empty()) return {};
    std::sort(models.begin(), models.end(), [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    if (models.size() > 1) {
        note(fmt::format("{} COLMAP models are in {}: using the largest, {} with {} images",
                         models.size(), folder.string(), models[0].second.filename().string(),
                         models[0].first));
    }
    return models[0].second;
}

fs::path colmap_model(const fs::path& folder) {
    for (const char* place : {"sparse", "colmap/sparse", "."}) {
        const fs::path several = folder / place;
        if (fs::path model = largest_colmap_model(several); !model.empty()) return model;
        if (is_colmap_model(several)) return several;
    }
    return {};
}

fs::path images_folder(const fs::path& folder, const DatasetOptions& options) {
    if (!options.images.empty()) {
        if (!fs::is_directory(options.images)) {
            throw InputError(options.images.string(), "is not a folder of images",
                             "check the path");
        }
        return options.images;
    }
    return fs::is_directory(folder / "images") ? folder / "images" : folder;
}

SourceDataset read_source(const fs::path& path, const DatasetOptions& options) {
    std::error_code problem;
    const fs::file_status status = fs::status(path, problem);
    if (problem && status.type() != fs::file_type::not_found)
        throw InputError(path.string(), "cannot be accessed: " + problem.message(),
                         "give the folder with the photographs and their poses");
    if (!fs::exists(status))
        throw InputError(path.string(), "no such file or folder",
                         "give the folder with the photographs and their poses");
    if (fs::is_directory(status)) {
        fs::directory_iterator listing(path, problem);
        if (problem)
            throw InputError(path.string(), "cannot be accessed: " + problem.message(),
                             "check its permissions");
    }
    const bool lists_images = fs::is_regular_file(status) ||
                              fs::exists(path / "transforms_train.json") ||
                              fs::exists(path / "transforms.json");
    if (lists_images && !options.images.empty())
        throw InputError("--images", "is only for COLMAP and LLFF; this dataset lists its images",
                         "leave it out");
    if (fs::is_regular_file(status))
        return path.filename() == "transforms_train.json" ? read_nerf_synthetic(path.parent_path())
                                                          : read_nerfstudio(path);
    if (fs::exists(path / "transforms_train.json")) return read_nerf_synthetic(path);
    if (fs::exists(path / "transforms.json")) return read_nerfstudio(path / "transforms.json");
    if (const fs::path model = colmap_model(path); !model.empty()) {
        return read_colmap(model, images_folder(path, options));
    }
    if (fs::exists(path / "poses_bounds.npy")) {
        return read_llff(path / "poses_bounds.npy", images_folder(path, options));
    }
    throw InputError(path.string(),
                     "contains none of transforms_train.json, transforms.json, "
                     "sparse/0/cameras.txt or .bin, poses_bounds.npy",
                     "expected a NeRF-synthetic, nerfstudio, COLMAP or LLFF dataset");
}

void choose_splits(SourceDataset& source, const DatasetOptions& options) {
    const auto is_unknown = [](const SourceView& v) { return v.split == Split::unknown; };
    if (std::all_of(source.views.begin(), source.views.end(), is_unknown)) {
        // Views are held out as in LLFF. No view is held out if the dataset has hardly enough
        // views.
        const std::size_t step = static_cast<std::size_t>(options.hold_out);
        const bool holds_out = step > 1 && source.views.size() >= fewest_views + step;
        for (std::size_t i = 0; i < source.views.size(); ++i)
            source.views[i].split = holds_out && i % step == step / 2 ? Split::test : Split::train;
    }
    if (options.max_views <= 0) return;
    std::vector<std::size_t> train;
    for (std::size_t i = 0; i < source.views.size(); ++i)
        if (source.views[i].split == Split::train) train.push_back(i);
    const auto wanted = static_cast<std::size_t>(options.max_views);
    if (train.size() <= wanted) return;
    for (const std::size_t i : train)
        source.views[i].split = Split::unknown;
    for (std::size_t i = 0; i < wanted; ++i)
        source.views[train[i * train.size() / wanted]].split = Split::train;
    std::erase_if(source.views, is_unknown);
}

/// Removes held-out views without images. Some programs write the cameras of a film that is yet to
/// be rendered as held-out views.
void leave_out_unseen_tests(const fs::path& path, SourceDataset& source) {
    const std::size_t before = source.views.size();
    std::erase_if(source.views, [](const SourceView& view) {
        std::error_code code;
        return view.split == Split::test && !fs::is_regular_file(view.image, code);
    });
    const std::size_t left_out = before - source.views.size();
    if (left_out == 0) return;
    warn(fmt::format("{}: {} held-out views have no image and are left out", path.string(),
                     left_out));
}

std::string origin_words(const std::map<MaskOrigin, std::size_t>& origins) {
    static const std::map<MaskOrigin, const char*> words{
        {MaskOrigin::none, "none"},
        {MaskOrigin::folder, "a folder"},
        {MaskOrigin::mask_path, "mask_path"},
        {MaskOrigin::alpha, "alpha"},
        {MaskOrigin::background, "the background colour"},
        {MaskOrigin::plain_border, "the detected plain background"}};
    std::string text;
    for (const auto& [origin, count] : origins)
        text += (text.empty() ? "" : ", ") + std::string(words.at(origin)) +
                (origins.size() > 1 ? fmt::format(" ({})", count) : "");
    return text;
}

struct Coverage {
    double share = 0;
    float brightest = 0;
    bool touches_edge = false;
};

Coverage coverage_of(const Image& image) {
    Coverage coverage;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const float alpha = image.at(x, y, 3);
            coverage.share += alpha;
            coverage.brightest = std::max(coverage.brightest, alpha);
            const bool edge = x == 0 || y == 0 || x + 1 == image.width || y + 1 == image.height;
            coverage.touches_edge = coverage.touches_edge || (edge && alpha > 0.5f);
        }
    }
    coverage.share /= static_cast<double>(image.width) * image.height;
    return coverage;
}

/// Throws if most masks are full, one is empty, or the object is cut off in all images.
void check_masks(const fs::path& path, Dataset& dataset) {
    std::size_t full = 0, total = 0;
    float brightest = 0;
    std::vector<std::string> empty;
    for (const auto* views : {&dataset.train, &dataset.test}) {
        for (const Photograph& view : *views) {
            const Coverage coverage = coverage_of(view.image);
            ++total;
            full += coverage.share > 0.999;
            brightest = std::max(brightest, coverage.brightest);
            if (coverage.share < 1e-5) empty.push_back(view.name);
            dataset.cut_off += coverage.touches_edge;
        }
    }
    const std::string hint =
        "give masks in the alpha channel, with --masks FOLDER, or with --background COLOUR for a "
        "plain background";
    if (full > total / 2) {
        throw InputError(
            path.string(),
            fmt::format("{} of {} images have a mask that covers the whole image (masks: {})", full,
                        total, dataset.masks),
            hint);
    }
    if (!empty.empty()) {
        throw InputError(
            path.string(),
            fmt::format("the mask of '{}' is black{}, so the object is not in the image",
                        empty.front(),
                        empty.size() > 1 ? fmt::format(" (and {} more)", empty.size() - 1) : ""),
            "remove such views from the dataset, or fix their masks");
    }
    if (brightest < 0.5f) {
        throw InputError(
            path.string(),
            fmt::format("the masks are dark, their maximum is {:.3g} of 255", 255 * brightest),
            "masks must be white on the object and black elsewhere");
    }
    if (dataset.cut_off == total) {
        throw InputError(path.string(), "the object is cut off at the edge of every image",
                         "some images must show the whole object");
    }
    if (dataset.cut_off > 0) {
        warn(fmt::format("the object touches the edge in {} of {} images", dataset.cut_off, total));
    }
}

void check_cameras(const fs::path& path, const Dataset& dataset) {
    if (dataset.train.size() < fewest_views) {
        throw InputError(path.string(), fmt::format("{} training view(s)", dataset.train.size()),
                         "at least 3 are required, 30 or more are recommended");
    }
    float spread = 0, turn = 0;
    const Camera& first = dataset.train.front().camera;
    const Vec3 position = first.position();
    for (const Photograph& view : dataset.train) {
        spread = std::max(spread, glm::distance(position, view.camera.position()));
        turn = std::max(turn, glm::distance(Vec3(first.camera_to_world[2]),
                                            Vec3(view.camera.camera_to_world[2])));
    }
    if (std::isfinite(spread) && (spread < 0.01f * glm::distance(position, dataset.centre) ||
                                  spread <= 5e-7f * glm::length(position))) {
        throw InputError(
            path.string(), "all cameras are at the same position",
            turn > 0.5f
                ? "camera-to-world matrices are required, check that these are not world-to-camera"
                : "views from different sides are required, check that the poses belong to the "
                  "images");
    }
    constexpr float smallest = 1e-4f, largest = 1e6f;
    if (dataset.radius < smallest || dataset.radius > largest) {
        throw InputError(
            path.string(),
            fmt::format("the object has a size of about {:.2g} units", 2 * dataset.radius),
            "scale the camera positions so that the size is between 0.001 and 100000");
    }
    // Positions are float32, which cannot resolve small distances far from the origin.
    if (spread < 1e-4f * glm::length(position)) {
        throw InputError(
            path.string(),
            fmt::format("the cameras are {:.3g} units from the origin but only {:.3g} apart",
                        glm::length(position), spread),
            "subtract the mean position from all of them to keep precision");
    }
}

}  // namespace

Dataset load_dataset(const fs::path& path, const DatasetOptions& options) {
    SourceDataset source = read_source(path, options);
    if (source.views.empty())
        throw InputError(path.string(), "the dataset has no views",
                         "it must list at least 3 images with poses");
    if (source.lenses_of_exif > 0) {
        note(fmt::format("{} focal lengths were read from EXIF", source.lenses_of_exif));
    }
    leave_out_unseen_tests(path, source);
    choose_splits(source, options);
    if (!options.masks.empty() && !fs::is_directory(options.masks)) {
        throw InputError(options.masks.string(), "is not a folder of masks", "check the path");
    }
    const fs::path folder = fs::is_directory(path) ? path : path.parent_path();
    const fs::path masks = !options.masks.empty() ? options.masks : folder / "masks";

    Dataset dataset;
    dataset.kind = source.kind;
    std::map<MaskOrigin, std::size_t> origins;
    std::string first_without_mask;
    int width = 0, height = 0;
    for (SourceView& from : source.views) {
        fs::path mask = find_mask(masks, from);
        if (mask.empty() && !options.masks.empty()) {
            throw InputError(options.masks.string(), "contains no mask for '" + from.name + "'",
                             "masks must have the names of their images, with .png");
        }
        const bool named = mask.empty() && !from.mask.empty();
        if (named) mask = from.mask;
        LoadedPhotograph loaded = load_photograph(from, mask, options);
        const MaskOrigin origin = named ? MaskOrigin::mask_path : loaded.mask;
        if (++origins[origin] == 1 && origin == MaskOrigin::plain_border)
            first_without_mask = from.name;
        from.camera_to_world = loaded.camera_to_world;
        Photograph view;
        view.name = from.name;
        view.image = std::move(loaded.image);
        view.exposure = loaded.exposure;
        view.file = from.image;
        // If the dataset gives one angle of view for all images, all images must have the same
        // size.
        if (from.lens.width == 0) {
            if (width == 0) {
                width = view.image.width;
                height = view.image.height;
            } else if (view.image.width != width || view.image.height != height) {
                throw InputError(
                    from.image.string(),
                    fmt::format("is {} x {}, but the previous images are {} x {}{}",
                                view.image.width, view.image.height, width, height,
                                options.longest_side > 0 ? " (after --longest-side)" : ""),
                    "camera_angle_x requires images of the same size");
            }
        }
        view.camera.name = from.name;
        view.camera.field_of_view_x = loaded.lens.field_of_view_x();
        view.camera.camera_to_world = from.camera_to_world;
        (from.split == Split::test ? dataset.test : dataset.train).push_back(std::move(view));
    }
    if (!first_without_mask.empty() && origins.size() > 1)
        throw InputError(
            path.string(),
            fmt::format("'{}' has no mask, but other images have one", first_without_mask),
            "add the mask, or remove this view from the dataset");
    dataset.world_from_dataset = upright(source, options.up);
    for (auto* views : {&dataset.train, &dataset.test})
        for (Photograph& view : *views)
            view.camera.camera_to_world =
                Mat4(dataset.world_from_dataset) * view.camera.camera_to_world;
    dataset.masks = origin_words(origins);
    std::tie(dataset.centre, dataset.radius) = region_seen(dataset.train);
    check_cameras(path, dataset);
    check_masks(path, dataset);
    return dataset;
}

std::vector<Photograph> some_views(const std::vector<Photograph>& views, std::size_t count) {
    std::vector<Photograph> chosen;
    for (std::size_t i = 0; i < std::min(count, views.size()); ++i)
        chosen.push_back(views[i * views.size() / std::min(count, views.size())]);
    return chosen;
}

}  // namespace item3d
