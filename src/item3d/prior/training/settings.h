// The settings of a training: by name of a recipe, and against those that it was begun with.
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

/// What an InstructPix2Pix is told: the latents of the picture that it changes.
inline constexpr const char* picture_condition = "picture";

struct TrainSettings {
    std::filesystem::path output;  ///< the diffusers folder
    std::filesystem::path work;    ///< data, checkpoints; may be deleted afterwards
    /// A prior whose weights, tokenizer and autoencoder this one begins with; empty: with nothing.
    std::filesystem::path begin_with;
    /// A prior whose autoencoder alone this one takes over; empty: it trains one.
    std::filesystem::path autoencoder;
    std::int64_t samples = 360000;       ///< pictures that the U-Net sees, repetitions counted
    std::int64_t data_samples = 112000;  ///< different pictures
    std::int64_t autoencoder_samples = 64000;
    std::int64_t autoencoder_pictures = 12000;
    std::int64_t clip_samples = 120000;       ///< that CLIP sees, repetitions counted
    std::int64_t captioner_samples = 800000;  ///< and the captioner
    std::int64_t labeled_samples = 240000;    ///< different pictures for these two
    std::int64_t segmenter_samples = 29000;   ///< that the segmenter sees, repetitions counted
    std::int64_t part_samples = 12000;        ///< different pictures for it
    int part_variants = 16;                   ///< shapes of each class on those
    int segmenter_batch = 8;                  ///< pictures a step and replica that it learns from
    int labeled_variants = 60;                ///< shapes of each class on those
    int shape_variants = 30;
    int views_each = 4;
    int lights = 480;
    int resolution = picture_size;  ///< of the pictures, 64 or 128; latents are 16 x 16 for both
    /// How often patterns come, against all other materials: 1 is 39 % of the pictures.
    float pattern_weight = 1;
    /// Widths of the U-Net's levels, multiples of 16.
    std::vector<int> widths{48, 96, 144};
    std::string condition = "surface";  ///< what it is told: or "depth", "none", picture_condition
    std::string prediction_type = "v_prediction";  ///< or "epsilon"
    std::string optimizer = "muon";                ///< of all but the autoencoder; or "adamw"
    int replicas = 2;                              ///< of each process; 1 on a CUDA device
    int batch = 32;                                ///< pictures a step and replica
    float learning_rate = 1e-3f;
    int word_pictures = 12;  ///< that each word is asked about at the end
    std::uint64_t seed = 1;
    bool resume = false;
    std::int64_t stop_after = 0;  ///< ends like an interrupt after so many pictures; 0: never
    double checkpoint_seconds = 120;
    double export_seconds = 600;
    ProcessGroup processes;  ///< that train together
    /// What the networks learn on, but for the autoencoder; pictures are drawn on the CPU.
    at::Device device = at::kCPU;
};

/// "embedded" (what is trained without a recipe) or "embedded-xl" (128 pixels, a wider U-Net).
/// Throws InputError for other names.
TrainSettings train_recipe(const std::string& name);
const std::vector<std::string>& train_recipe_names();

/// Threads that pictures are drawn on.
int drawing_threads(const TrainSettings& settings);

/// Which of all processes' replicas this process's replica of that number is.
int global_rank(const TrainSettings& settings, int rank);

/// What the data depends on: a work folder made with other settings is not gone on with. Replicas
/// are those of all processes, so that a training may go on with them spread otherwise.
nlohmann::json data_settings_json(const TrainSettings& settings);
/// All that results depend on. Processes that train together must agree in it.
nlohmann::json settings_json(const TrainSettings& settings);

/// The members of `now` that differ, as "batch: 16 instead of 32, ..."; what `before` lacks is
/// not compared, so that older files stay good. Empty where nothing differs.
std::string changed_settings(const nlohmann::json& before, const nlohmann::json& now);

/// A float as it is written: 0.001, not the digits of the nearest one.
double as_written(float value);

/// Throws InputError, naming `file`, where `before` is no JSON object or says otherwise than `now`.
void check_settings(const std::filesystem::path& file, const nlohmann::json& before,
                    const nlohmann::json& now);

/// A JSON object of the work folder. Throws InputError for anything else.
nlohmann::json read_work_json(const std::filesystem::path& file);

/// Throws InputError where this process was started with other settings than process 0.
void check_same_settings(const ProcessGroup& processes, const nlohmann::json& settings);

}  // namespace item3d
