// Settings of a training, named recipes, and the comparison of settings with those of an earlier
// run.
#pragma once

#include "item3d/prior/data/views.h"
#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Name of the condition of an InstructPix2Pix: the latents of the image to be changed.
inline constexpr const char* image_condition = "picture";

struct TrainSettings {
    std::filesystem::path output;  ///< the diffusers folder
    std::filesystem::path work;    ///< data and checkpoints; may be deleted afterwards
    /// Prior whose weights, tokenizer and autoencoder the training starts from, if not empty.
    std::filesystem::path init_from;
    /// Prior of which only the autoencoder is used. If empty, an autoencoder is trained.
    std::filesystem::path autoencoder;
    std::int64_t samples = 360000;       ///< images that the U-Net sees, repetitions counted
    std::int64_t data_samples = 112000;  ///< distinct images
    std::int64_t autoencoder_samples = 64000;
    std::int64_t autoencoder_images = 12000;
    std::int64_t clip_samples = 120000;  ///< images that CLIP sees, repetitions counted
    std::int64_t captioner_samples =
        800000;                             ///< images that the captioner sees, repetitions counted
    std::int64_t labeled_samples = 240000;  ///< distinct images for CLIP and captioner
    std::int64_t segmenter_samples =
        29000;                          ///< images that the segmenter sees, repetitions counted
    std::int64_t part_samples = 12000;  ///< distinct images for the segmenter
    int part_variants = 16;             ///< shapes of each class in part_samples
    int segmenter_batch = 8;            ///< images per step and replica
    int labeled_variants = 60;          ///< shapes of each class in labeled_samples
    int shape_variants = 30;
    int views_each = 4;
    int lights = 480;
    /// Edge of the images, 64 or 128 pixels. For both, latents are 16 x 16.
    int resolution = prior_image_size;
    /// Weight of patterns relative to all other materials. At 1, 39 % of the images have patterns.
    float pattern_weight = 1;
    /// Widths of the U-Net's levels, multiples of 16.
    std::vector<int> widths{48, 96, 144};
    /// "surface", "depth", "none" or image_condition.
    std::string condition = "surface";
    std::string prediction_type = "v_prediction";  ///< "v_prediction" or "epsilon"
    std::string optimizer = "muon";  ///< "muon" or "adamw"; the autoencoder uses AdamW
    int replicas = 2;                ///< number in each process; 1 on a CUDA device
    int batch = 32;                  ///< images per step and replica
    float learning_rate = 1e-3f;
    int word_images = 12;  ///< images per word in the final measurement
    std::uint64_t seed = 1;
    bool resume = false;
    std::int64_t stop_after = 0;  ///< stops like an interrupt after so many images; 0 for never
    double checkpoint_seconds = 120;
    double export_seconds = 600;
    ProcessGroup processes;  ///< processes that train together
    /// Training device of the networks except the autoencoder; images are drawn on the CPU.
    at::Device device = at::kCPU;
};

/// Returns "embedded" (the default recipe) or "embedded-xl" (128 pixels, a wider U-Net). Throws
/// InputError for other names.
TrainSettings train_recipe(const std::string& name);
const std::vector<std::string>& train_recipe_names();

/// Returns the number of threads that draw images.
int drawing_threads(const TrainSettings& settings);

/// Returns the index of this process's replica `rank` among the replicas of all processes.
int global_rank(const TrainSettings& settings, int rank);

/// Returns the settings that the data depends on. A work folder with other settings is not resumed.
/// The number of replicas is the sum over all processes, so that a resumed training may distribute
/// them differently.
nlohmann::json data_settings_json(const TrainSettings& settings);
/// Returns all settings that results depend on. Processes that train together must agree on them.
nlohmann::json settings_json(const TrainSettings& settings);

/// Returns the differing members of `now` as "batch: 16 instead of 32, ...", or "" if none differ.
/// Members that `before` lacks are not compared, so that older files stay valid.
std::string changed_settings(const nlohmann::json& before, const nlohmann::json& now);

/// Returns the double with a float's shortest decimal representation: 0.001.
double as_written(float value);

/// Throws InputError that names `file` if `before` is not a JSON object or differs from `now`.
void check_settings(const std::filesystem::path& file, const nlohmann::json& before,
                    const nlohmann::json& now);

/// Reads a JSON object of the work folder. Throws InputError for anything else.
nlohmann::json read_work_json(const std::filesystem::path& file);

/// Throws InputError if this process's settings differ from those of process 0.
void check_same_settings(const ProcessGroup& processes, const nlohmann::json& settings);

}  // namespace item3d
