// Initialization of a training from an existing prior.
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

/// Throws InputError if the prior in settings.init_from or settings.autoencoder does not fit, or
/// both are given. Runs before the data is drawn.
void check_init_from(const TrainSettings& settings);

/// Loads the autoencoder of the prior in `folder`. Throws InputError if its config differs from
/// prior_autoencoder_config(resolution).
std::shared_ptr<AutoencoderTiny> init_from_autoencoder(const std::filesystem::path& folder,
                                                       int resolution);

/// Returns the training record of the autoencoder of the prior in `folder`, for the new prior:
/// {"psnr", "object_psnr"}.
nlohmann::json autoencoder_record(const std::filesystem::path& folder);
/// Returns autoencoder_record(), with the whole training record of the prior in `folder` added as
/// "begun_with".
nlohmann::json init_from_record(const std::filesystem::path& folder);

/// Copies the weights of the prior in `folder`. Shape channels that only this U-Net has get weights
/// of 0. by_images: this U-Net is conditioned on images; the weights of all shape channels become
/// 0. Throws InputError if its networks are of other sizes.
void init_from_weights(const std::filesystem::path& folder, UNet2DCondition& unet,
                       ClipTextModel& text, bool by_images = false);

/// Returns the captioner's, CLIP's or segmenter's folder of the prior in settings.init_from; empty
/// if there is no prior or no such part.
std::filesystem::path init_from_part(const TrainSettings& settings, const char* part);

/// Throws InputError if the CLIP or captioner of the prior in settings.init_from does not fit.
/// clip, captioner: which of them to check. Runs before the images are drawn.
void check_init_from_readers(const TrainSettings& settings, bool clip, bool captioner);

/// Copy the weights of a captioner's, CLIP's or segmenter's folder. Throw InputError if its network
/// is of another size.
void init_from_captioner(const std::filesystem::path& folder, BlipModel& model);
void init_from_clip(const std::filesystem::path& folder, ClipModel& model);
void init_from_segmenter(const std::filesystem::path& folder, ClipSegModel& model);

}  // namespace item3d
