#include "item3d/reconstruct/dataset/find_poses.h"

#include "item3d/core/child_program.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/reconstruct/dataset/colmap.h"
#include "item3d/reconstruct/dataset/colmap_program.h"
#include "item3d/reconstruct/dataset/pose_images.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace item3d {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t fewest_images = 3;
/// Number of images above which matching all pairs takes too long.
constexpr std::size_t max_exhaustive = 150;
/// Number of images per block. COLMAP reports progress after each pair of blocks, so its default of
/// 50 would show no progress.
constexpr std::size_t matcher_block = 10;
/// Number of lenses above which each image gets its own lens. Images that were cropped by hand have
/// so many lenses.
constexpr std::size_t max_lenses = 8;
/// Approximate number of features per image. Matching time grows quadratically with it. COLMAP's
/// default of 8192 is meant for matching on a GPU.
constexpr int max_features = 2048;

// ---- Images ----

/// Returns the mask of each image, named as COLMAP requires. The result is empty if any image has
/// no such mask.
std::vector<fs::path> masks_for_colmap(const PoseSearch& search, const PoseImages& images) {
    if (search.masks.empty()) return {};
    if (!fs::is_directory(search.masks))
        throw InputError(search.masks.string(), "is not a folder of masks", "check the path");
    std::vector<fs::path> masks;
    for (const fs::path& image : images.files) {
        masks.push_back(search.masks / (image.filename().string() + ".png"));
        if (!fs::is_regular_file(masks.back())) return {};
    }
    return masks;
}

json list_files(const std::vector<fs::path>& files) {
    json list = json::array();
    for (const fs::path& file : files) {
        list.push_back({{"name", file.filename().string()},
                        {"bytes", fs::file_size(file)},
                        {"modified", std::int64_t{fs::last_write_time(file).time_since_epoch() /
                                                  std::chrono::nanoseconds(1)}}});
    }
    return list;
}

// ---- Steps ----

/// Returns the extraction step. All files share one lens, which starts from EXIF's focal length if
/// that is known. If `lens` is null, each file has its own lens.
ColmapStep extraction(const PoseSearch& search, const std::vector<fs::path>& files,
                      const LensImages* lens, bool has_masks, const fs::path& folder) {
    std::string names;
    for (const fs::path& file : files)
        names += file.filename().string() + "\n";
    write_atomically(folder / "pictures.txt", std::string_view(names));
    ColmapStep step{"features",
                    "Processed file",
                    static_cast<std::int64_t>(files.size()),
                    "feature_extractor",
                    {"--database_path", (folder / "database.db").string(), "--image_path",
                     fs::absolute(search.images).string(), "--image_list_path",
                     (folder / "pictures.txt").string(), "--ImageReader.camera_model",
                     "SIMPLE_RADIAL", "--ImageReader.single_camera", lens != nullptr ? "1" : "0",
                     "--SiftExtraction.max_num_features", std::to_string(max_features)}};
    if (lens != nullptr && lens->focal_pixels > 0) {
        step.arguments.push_back("--ImageReader.camera_params");
        step.arguments.push_back(fmt::format("{:.2f},{},{},0", lens->focal_pixels,
                                             0.5 * lens->size.width, 0.5 * lens->size.height));
    }
    if (has_masks) {
        step.arguments.push_back("--ImageReader.mask_path");
        step.arguments.push_back(fs::absolute(search.masks).string());
    }
    return step;
}

ColmapStep matching(std::size_t images, const fs::path& folder) {
    const bool all = images <= max_exhaustive;
    const std::size_t blocks = (images + matcher_block - 1) / matcher_block;
    ColmapStep step{"matches",
                    all ? "ing block [" : "ing image [",
                    static_cast<std::int64_t>(all ? blocks * blocks : images),
                    all ? "exhaustive_matcher" : "sequential_matcher",
                    {"--database_path", (folder / "database.db").string()}};
    if (all) {
        step.arguments.push_back("--ExhaustiveMatching.block_size");
        step.arguments.push_back(std::to_string(matcher_block));
    }
    return step;
}

ColmapStep mapping(const PoseSearch& search, std::size_t images, int threads,
                   const fs::path& folder) {
    return {"poses",
            "Registering image #",
            static_cast<std::int64_t>(images),
            "mapper",
            {"--database_path", (folder / "database.db").string(), "--image_path",
             fs::absolute(search.images).string(), "--output_path", (folder / "sparse").string(),
             "--Mapper.num_threads", std::to_string(threads)}};
}

/// Returns the model with the most images, as load_dataset() does. Returns an empty path if there
/// is no model.
fs::path largest_model(const fs::path& sparse) {
    fs::path largest;
    std::size_t maximum = 0;
    std::error_code code;
    for (fs::directory_iterator i(sparse, code), end; !code && i != end; i.increment(code)) {
        const std::size_t count = is_colmap_model(i->path()) ? count_colmap_images(i->path()) : 0;
        if (count > maximum) {
            maximum = count;
            largest = i->path();
        }
    }
    return largest;
}

constexpr const char* no_poses_hint =
    "take more images that overlap, put an object without texture on a printed sheet, or give "
    "masks named IMAGE.jpg.png if the object was rotated in front of a fixed camera";

std::size_t count_poses(const fs::path& folder) {
    const fs::path model = largest_model(folder / "sparse");
    return model.empty() ? 0 : count_colmap_images(model);
}

void check_poses(const PoseSearch& search, const PoseImages& images, const fs::path& folder) {
    const fs::path model = largest_model(folder / "sparse");
    if (model.empty()) {
        throw InputError(search.images.string(),
                         "no poses were found, because the images share too few features",
                         no_poses_hint);
    }
    std::set<fs::path> found;
    for (const SourceView& view : read_colmap(model, search.images).views)
        found.insert(view.image.filename());
    std::vector<std::string> lost;
    for (const fs::path& file : images.files)
        if (!found.contains(file.filename())) lost.push_back(file.filename().string());
    const std::size_t all = images.files.size(), with_pose = all - lost.size();
    if (with_pose < fewest_images) {
        throw InputError(search.images.string(),
                         fmt::format("poses were found for only {} of {} images", with_pose, all),
                         no_poses_hint);
    }
    if (lost.empty()) {
        note(fmt::format("COLMAP found the poses of all {} images", all));
        return;
    }
    const std::size_t shown = std::min<std::size_t>(lost.size(), 3);
    const std::vector<std::string> first(lost.begin(),
                                         lost.begin() + static_cast<std::ptrdiff_t>(shown));
    warn(fmt::format("poses were found for {} of {} images; left out: {}{}", with_pose, all,
                     fmt::join(first, ", "),
                     lost.size() > shown ? fmt::format(" and {} more", lost.size() - shown) : ""));
}

// ---- Folder ----

constexpr const char* record_name = "pictures.json";

/// True if the folder holds the result for these images. Throws InputError if it was not written by
/// find_poses().
bool is_found_before(const fs::path& folder, const json& record) {
    if (!fs::exists(folder)) return false;
    if (!fs::is_regular_file(folder / record_name)) {
        throw InputError(folder.string(), "exists but was not written by a pose estimation",
                         "use it as the dataset, or choose another -o");
    }
    const json before = parse_json(read_text(folder / record_name));
    return before == record && !largest_model(folder / "sparse").empty();
}

/// Folder that is removed at the end of this object's scope unless it became the result.
class PartialFolder {
  public:
    explicit PartialFolder(fs::path folder) : folder_(std::move(folder)) {
        remove(folder_);
        make_output_folder(folder_ / "sparse");
    }
    ~PartialFolder() { remove(folder_); }
    PartialFolder(const PartialFolder&) = delete;
    PartialFolder& operator=(const PartialFolder&) = delete;

    const fs::path& path() const { return folder_; }

    void become(const fs::path& result) {
        remove(result);
        std::error_code code;
        fs::rename(folder_, result, code);
        if (code) throw ResourceError(result.string() + ": cannot be created: " + code.message());
    }

  private:
    static void remove(const fs::path& folder) {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }

    fs::path folder_;
};

/// Writes the models into folder/sparse. Writes no model if the images do not suffice.
void run_colmap(const ColmapProgram& colmap, const PoseSearch& search, const PoseImages& images,
                bool has_masks, const fs::path& folder) {
    const fs::path scratch = folder / "help.txt";
    const auto extract = [&](const std::vector<fs::path>& files, const LensImages* lens) {
        ColmapStep step = extraction(search, files, lens, has_masks, folder);
        colmap.add_device(step, "FeatureExtraction", "SiftExtraction", scratch);
        colmap.check(step, colmap.run(step));
    };
    // The extraction runs once per lens, because there is no other way to specify which images
    // share a lens.
    if (images.lenses.size() <= max_lenses) {
        for (const LensImages& lens : images.lenses)
            extract(lens.files, &lens);
    } else {
        extract(images.files, nullptr);
    }
    ColmapStep step = matching(images.files.size(), folder);
    colmap.add_device(step, "FeatureMatching", "SiftMatching", scratch);
    colmap.check(step, colmap.run(step));
    step = mapping(search, images.files.size(), colmap.threads(), folder);
    const ColmapOutcome outcome = colmap.run(step);
    // COLMAP fails if it finds no model; check_poses() explains that.
    if (outcome.telling.find("failed to create sparse model") == std::string::npos)
        colmap.check(step, outcome);
    for (const char* name : {"help.txt", "pictures.txt"})
        fs::remove(folder / name);
}

}  // namespace

fs::path find_poses(const PoseSearch& search) {
    const PoseImages images = find_pose_images(search.images);
    const std::vector<fs::path> masks = masks_for_colmap(search, images);
    const json record = {{"pictures", list_files(images.files)}, {"masks", list_files(masks)}};
    const fs::path result = fs::absolute(search.output) / "colmap";
    if (is_found_before(result, record)) {
        note("the poses in " + (search.output / "colmap").string() + " are reused");
        check_poses(search, images, result);
        return search.output / "colmap";
    }
    const fs::path program = program_in_path("colmap");
    if (program.empty()) {
        throw ResourceError(
            "colmap was not found; install it (apt install colmap), or give poses in a "
            "transforms.json");
    }

    const OutputFolder output(search.output);
    const fs::path log = result.parent_path() / "colmap.log";
    std::error_code ignored;
    fs::remove(log, ignored);
    PartialFolder partial(result.parent_path() / "colmap.partial");
    std::optional<PartialFolder> with_surroundings;
    PartialFolder* best = &partial;
    const ColmapProgram colmap(program, log, search.threads);
    try {
        run_colmap(colmap, search, images, !masks.empty(), partial.path());
        const std::size_t found = count_poses(partial.path());
        if (!masks.empty() && 2 * found < images.files.size()) {
            note(
                fmt::format("COLMAP found {} of {} poses within the masks; it tries again with the "
                            "surroundings",
                            found, images.files.size()));
            with_surroundings.emplace(result.parent_path() / "colmap.again");
            run_colmap(colmap, search, images, false, with_surroundings->path());
            if (count_poses(with_surroundings->path()) > found) best = &*with_surroundings;
        }
        check_poses(search, images, best->path());
    } catch (const Interrupted&) {
        fs::remove(log, ignored);
        throw;
    }
    write_atomically(best->path() / record_name, std::string_view(record.dump(1) + "\n"));
    fs::rename(log, best->path() / "colmap.log", ignored);
    best->become(result);
    return search.output / "colmap";
}

}  // namespace item3d
