// Training of the prior's small CLIP and captioner on the same images, with plain sentences about
// them (labels.h).
#pragma once

#include "item3d/networks/vision_language/vision_shape.h"
#include "item3d/prior/data/labeled_images.h"
#include "item3d/prior/training/settings.h"
#include "item3d/prior/training/training_loop.h"
#include "item3d/tensors/tensor.h"
#include "item3d/text/clip_tokenizer.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Input edge of both networks in pixels. An input has 5 x 5 patches of 12 pixels. An input of 64
/// pixels would have 8 x 8 patches of 8 pixels.
inline constexpr int read_size = 60;
/// Vision transformer of both networks. Both have the same shape, so that CLIP can start from the
/// captioner's weights.
inline constexpr VisionShape prior_vision_shape{.hidden_size = 192,
                                                .intermediate_size = 768,
                                                .num_hidden_layers = 6,
                                                .num_attention_heads = 6,
                                                .image_size = read_size,
                                                .patch_size = 12};

/// Runs the whole training of CLIP and captioner, or of one of them. It draws the images, trains
/// the networks and measures them. Fills the sub-folders, and "clip" and "captioner" of prior.json,
/// in settings.output.
void train_vision_language(const TrainSettings& settings, bool clip, bool captioner);

// Common parts of the two trainings:

/// Augments training images [N, 3, prior_image_size, prior_image_size] to [N, 3, read_size,
/// read_size]: mirrors each image or not, and either shrinks or crops the whole batch, at random.
at::Tensor augment(const at::Tensor& pixel_values, Random& random);
/// Returns loop_options() with the warm-up of CLIP and captioner.
LoopOptions vision_language_loop(const std::string& name, const TrainSettings& settings,
                                 std::int64_t samples, std::int64_t rows);
nlohmann::json loop_summary(const LoopRecord& record, std::int64_t parameters,
                            const TrainSettings& settings);
/// Writes the preprocessor_config.json of networks that read squares of `size` pixels in [-1, 1].
void write_preprocessor(const std::filesystem::path& folder, const std::string& processor_class,
                        int size = read_size);
/// Tokenizes texts to [N, S] int64; S is the length of the longest, at most text_length.
at::Tensor read_sentences(const ClipTokenizer& tokenizer, const std::vector<std::string>& texts);
/// Throws Interrupted after an interrupt. The message tells the user how to continue.
void stop_here_if_interrupted(const TrainSettings& settings);

}  // namespace item3d
