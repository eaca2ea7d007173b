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

/// Throws InputError if the prior in settings.init_from or settings.autoencoder does not fit, or if
/// both are given. The check runs before the data is drawn.
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

/// Copies the weights of the prior in `folder`. Shape channels that only `unet` has get weights of
/// 0. by_images: true if `unet` is conditioned on images; then the weights of all shape channels
/// become 0. Throws InputError if the prior's networks are of other sizes.
void init_from_weights(const std::filesystem::path& folder, UNet2DCondition& unet,
                       ClipTextModel& text, bool by_images = false);

/// Returns the folder of the captioner, CLIP or segmenter (`part`) in the prior in
/// settings.init_from. Returns an empty path if there is no prior or the prior lacks this network.
std::filesystem::path init_from_part(const TrainSettings& settings, const char* part);

/// Throws InputError if the CLIP or captioner of the prior in settings.init_from does not fit.
/// clip, captioner: true if this network is to be checked. The check runs before the images are
/// drawn.
void check_init_from_readers(const TrainSettings& settings, bool clip, bool captioner);

/// The next three functions copy the weights in the folder of a captioner, CLIP or segmenter. They
/// throw InputError if the network in the folder is of another size.
void init_from_captioner(const std::filesystem::path& folder, BlipModel& model);
void init_from_clip(const std::filesystem::path& folder, ClipModel& model);
void init_from_segmenter(const std::filesystem::path& folder, ClipSegModel& model);

}  // namespace item3d
