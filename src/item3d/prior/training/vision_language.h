// The small CLIP and captioner beside the prior: trained on the same pictures, with plain sentences
// about them (labels.h).
#pragma once

#include "item3d/networks/vision_language/vision_shape.h"
#include "item3d/prior/data/labeled_pictures.h"
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

/// Pixels a side that both networks read. Coarse patches are fewer: 25 instead of the 64 of 8
/// pixels.
inline constexpr int read_size = 60;
/// The vision transformer of both, so that CLIP's can begin as the captioner's.
inline constexpr VisionShape prior_vision_shape{.hidden_size = 192,
                                                .intermediate_size = 768,
                                                .num_hidden_layers = 6,
                                                .num_attention_heads = 6,
                                                .image_size = read_size,
                                                .patch_size = 12};

/// The whole training of both, or of one of them: pictures, networks, measurement. Fills the
/// sub-folders, and "clip" and "captioner" of the folder's prior.json.
void train_vision_language(const TrainSettings& settings, bool clip, bool captioner);

// What the two trainings share:

/// Pictures [N, 3, picture_size, picture_size] as the networks see them in training: [N, 3,
/// read_size, read_size], each mirrored or not, all of them either shrunken or a random part.
at::Tensor augment(const at::Tensor& pixel_values, Random& random);
/// As loop_options(), with the rise that these networks want.
LoopOptions vision_language_loop(const std::string& name, const TrainSettings& settings,
                                 std::int64_t samples, std::int64_t rows);
nlohmann::json loop_summary(const LoopRecord& record, std::int64_t parameters,
                            const TrainSettings& settings);
/// preprocessor_config.json of networks that read squares of `size` pixels in [-1, 1].
void write_preprocessor(const std::filesystem::path& folder, const std::string& processor_class,
                        int size = read_size);
/// [N, S] int64, S as long as the longest needs, at most text_length.
at::Tensor read_sentences(const ClipTokenizer& tokenizer, const std::vector<std::string>& texts);
/// Throws Interrupted, with what to do next, after an interrupt.
void stop_here_if_interrupted(const TrainSettings& settings);

}  // namespace item3d
