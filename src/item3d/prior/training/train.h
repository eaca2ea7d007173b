// Training the embedded prior from nothing: data, tokenizer, autoencoder, text encoder and U-Net.
#pragma once

#include "item3d/networks/diffusion/autoencoder.h"
#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/dataset.h"
#include "item3d/prior/training/process_group.h"
#include "item3d/text/clip_tokenizer.h"

#include <nlohmann/json.hpp>
#include <torch/types.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace item3d {

struct LoopOptions;

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
    int labeled_variants = 60;                ///< shapes of each class on those
    int shape_variants = 30;
    int views_each = 4;
    int lights = 480;
    int resolution = picture_size;  ///< of the pictures, 64 or 128; latents are 16 x 16 for both
    /// How often patterns come, against all other materials: 1 is 39 % of the pictures.
    float pattern_weight = 1;
    /// Widths of the U-Net's levels, multiples of 16.
    std::vector<int> widths{48, 96, 144};
    std::string condition = "surface";             ///< what it is told: or "depth", or "none"
    std::string prediction_type = "v_prediction";  ///< or "epsilon"
    std::string optimizer = "muon";                ///< of all but the autoencoder; or "adamw"
    int replicas = 2;                              ///< of each process
    int batch = 32;                                ///< pictures a step and replica
    float learning_rate = 1e-3f;
    int word_pictures = 12;  ///< that each word is asked about at the end
    std::uint64_t seed = 1;
    bool resume = false;
    std::int64_t stop_after = 0;  ///< ends like an interrupt after so many pictures; 0: never
    double checkpoint_seconds = 120;
    double export_seconds = 600;
    ProcessGroup processes;  ///< that train together
};

/// "embedded" (what is trained without a recipe) or "embedded-xl" (128 pixels, a wider U-Net).
/// Throws InputError for other names.
TrainSettings train_recipe(const std::string& name);
const std::vector<std::string>& train_recipe_names();

/// Which of all processes' replicas this process's replica of that number is.
int global_rank(const TrainSettings& settings, int rank);

/// All that results depend on. Processes that train together must agree in it.
nlohmann::json settings_json(const TrainSettings& settings);

/// What all training loops take from the settings; samples and rows are the caller's to say.
/// checkpoint: the file's name.
LoopOptions loop_options(const TrainSettings& settings, const std::string& label,
                         const std::string& checkpoint);

/// The words that all tokenizers are made of.
std::vector<WordCount> prior_words(const TrainSettings& settings);

/// What the U-Net learns from, encoded. N rows.
struct LatentData {
    /// As they are called in a file. from_tensors() throws InputError, naming the file, for what
    /// does not belong together or has tokens beyond the vocabulary.
    NamedTensors tensors() const;
    static LatentData from_tensors(const NamedTensors& tensors, std::size_t vocabulary,
                                   const std::filesystem::path& file);

    torch::Tensor latents;       ///< [N, latent_channels, 16, 16] fp16, scaled
    torch::Tensor cells;         ///< [N, 7, 16, 16] fp16, shape_cells()
    torch::Tensor tokens;        ///< [N, text_length] int16
    torch::Tensor empty_tokens;  ///< [text_length] int16, the empty prompt
};

inline constexpr int text_length = longest_caption + 2;  ///< and the ends

/// Pictures for the autoencoder.
struct PictureData {
    torch::Tensor images;   ///< [N, S, S, 3] uint8 sRGB
    torch::Tensor covered;  ///< [N, S, S] uint8
};

/// Downsamples pictures of that resolution to latent_size.
AutoencoderTinyConfig prior_autoencoder_config(int resolution = picture_size);
UNet2DConditionConfig prior_unet_config(const TrainSettings& settings = {});
ClipTextConfig prior_text_config(int vocabulary, int start_of_text, int end_of_text);

/// Trains (or, when resuming, reads) the autoencoder. Sets its scaling factor. Returns it with its
/// held-out PSNR in dB, over `held_out` pictures.
struct TrainedAutoencoder {
    std::shared_ptr<AutoencoderTiny> model;
    double psnr = 0;
    double object_psnr = 0;  ///< of object pixels alone
};
TrainedAutoencoder train_autoencoder(const PictureData& pictures, const PictureData& held_out,
                                     const TrainSettings& settings);

/// What the networks that learn together look like.
struct DiffusionConfig {
    UNet2DConditionConfig unet;
    ClipTextConfig text;
};

/// Trains text encoder and U-Net together. Exports now and then, in process 0. Throws Interrupted
/// after writing a checkpoint. Returns {"samples", "loss", "seconds", ...} there.
nlohmann::json train_diffusion(const LatentData& data, const TrainSettings& settings,
                               const DiffusionConfig& networks, const nlohmann::json& so_far);

/// The whole training; fills settings.output and measures it. Process 0 makes the data and writes
/// everything; the others get all that they need from it.
void train_prior(const TrainSettings& settings);

/// The words that the prior in `folder` was trained on: those of its prior.json, or, where that has
/// none, those of today's captions that its tokenizer has whole.
std::set<std::string> trained_words(const std::filesystem::path& folder,
                                    const ClipTokenizer& tokenizer);

/// Measures the prior in `folder` (classifier.h) by the words that it was trained on and puts the
/// result, with these words, into its prior.json. Returns what that then holds.
nlohmann::json write_measurement(const std::filesystem::path& folder, int word_pictures,
                                 int threads);

}  // namespace item3d
