// What a training takes over from a prior that is there already.
#pragma once

#include "item3d/networks/diffusion/autoencoder_tiny.h"
#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/vision_language/blip.h"
#include "item3d/networks/vision_language/clip_model.h"
#include "item3d/networks/vision_language/clip_seg.h"
#include "item3d/networks/vision_language/clip_text.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace item3d {

struct TrainSettings;

/// Throws InputError where the prior in settings.begin_with or settings.autoencoder does not fit,
/// or both are given: before the data is drawn.
void check_begin_with(const TrainSettings& settings);

/// The autoencoder of the prior in `folder`. Throws InputError where it is of another kind than
/// prior_autoencoder_config(resolution).
std::shared_ptr<AutoencoderTiny> begin_with_autoencoder(const std::filesystem::path& folder,
                                                        int resolution);

/// What its training wrote down about its autoencoder, for the new one's: {"psnr", "object_psnr"}.
nlohmann::json autoencoder_record(const std::filesystem::path& folder);
/// The same and {"begun_with": all of it}.
nlohmann::json begin_with_record(const std::filesystem::path& folder);

/// Copies the weights of the prior in `folder`. Where its U-Net is told less of the shape than this
/// one, weights for the rest are 0. by_pictures: this one is told of pictures; of one that was told
/// of shapes, the weights for these become 0 too. Throws InputError where its networks are of other
/// sizes.
void begin_with_weights(const std::filesystem::path& folder, UNet2DCondition& unet,
                        ClipTextModel& text, bool by_pictures = false);

/// The captioner's, CLIP's or segmenter's folder of the prior that a training begins with; empty
/// where it begins with none, or with one that has no such part.
std::filesystem::path begin_with_part(const TrainSettings& settings, const char* part);

/// Throws InputError where these parts of the prior in settings.begin_with do not fit: before the
/// pictures are drawn.
void check_begin_with_readers(const TrainSettings& settings, bool clip, bool captioner);

/// Copy the weights of a captioner's, CLIP's or segmenter's folder. Throw InputError where it is of
/// another size.
void begin_with_captioner(const std::filesystem::path& folder, BlipModel& model);
void begin_with_clip(const std::filesystem::path& folder, ClipModel& model);
void begin_with_segmenter(const std::filesystem::path& folder, ClipSegModel& model);

}  // namespace item3d
