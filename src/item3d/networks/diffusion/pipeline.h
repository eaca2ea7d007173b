// A text-to-image diffusion model in the diffusers layout, whole.
#pragma once

#include "item3d/networks/diffusion/autoencoder.h"
#include "item3d/networks/diffusion/controlnet.h"
#include "item3d/networks/diffusion/noise_schedule.h"
#include "item3d/networks/diffusion/text_embedding.h"
#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/text/clip_tokenizer.h"

#include <torch/types.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

class Pipeline {
  public:
    /// Reads model_index.json and its sub-folders (tokenizer, text_encoder, unet, vae, scheduler;
    /// for SDXL tokenizer_2 and text_encoder_2 too). Weights are cast once to `dtype` (text
    /// encoders and schedules stay float32). Throws InputError naming the file for anything
    /// missing, of the wrong shape, or unsupported.
    static Pipeline load(const std::filesystem::path& folder, torch::Device device = torch::kCPU,
                         torch::Dtype dtype = torch::kFloat32);
    /// load() in two parts, for who is done with the text before the other networks are needed:
    /// the tokenizers and text encoders, for encode_text() and keep_texts(); then U-Net,
    /// autoencoder and schedule. Throw as load().
    static Pipeline load_text(const std::filesystem::path& folder,
                              torch::Device device = torch::kCPU);
    void load_networks(const std::filesystem::path& folder, torch::Device device = torch::kCPU,
                       torch::Dtype dtype = torch::kFloat32, bool with_decoder = true,
                       WeightUse use = WeightUse::any);
    /// Writes the same layout, weights as `dtype` (float32 or float16), each file atomically and
    /// model_index.json last, so that a folder that has one is whole.
    void save(const std::filesystem::path& folder, torch::Dtype dtype = torch::kFloat16) const;

    /// float32, of padded and truncated prompts: the last hidden states; for SDXL the last but one
    /// of both encoders side by side, and the second encoder's projected pooled state.
    TextEmbedding encode_text(const std::vector<std::string>& prompts) const;
    /// One row: what classifier-free guidance goes away from when nobody says what. The empty
    /// prompt, or zeros where model_index.json says force_zeros_for_empty_prompt (SDXL).
    TextEmbedding encode_no_text() const;
    /// Encodes these prompts and no text, and lets the text encoders go. From then on encode_text()
    /// knows these prompts alone; the pipeline cannot be saved any more.
    void keep_texts(const std::vector<std::string>& prompts);
    /// For pipelines that run and do nothing else from now on: lets convolutions give up weights
    /// that they keep packed. The pipeline cannot be saved any more.
    void give_up_weights();
    /// images [N, 3, H, W] in [-1, 1] -> latents [N, C, h, w], scaled (mean of the posterior);
    /// differentiable in images. float32.
    torch::Tensor encode_image(const torch::Tensor& images) const;
    /// Inverse of encode_image, images in [-1, 1], not clamped. float32.
    torch::Tensor decode_image(const torch::Tensor& latents) const;
    /// U-Net's noise prediction eps (v-prediction is converted), float32. `condition`: extra input
    /// channels [N, c, h, w] (or one row for all), concatenated to the latents where the U-Net
    /// takes them; left out, they are zero, which the embedded prior knows as "no shape". text: N
    /// rows or one for all. SDXL is told that the picture is neither scaled nor cropped.
    /// Differentiable in whatever asks for it. With a ControlNet, `condition` is its picture [N, 3,
    /// H, W]; left out, the ControlNet is not asked.
    torch::Tensor predict_noise(const torch::Tensor& noisy_latents, const torch::Tensor& timesteps,
                                const TextEmbedding& text,
                                const torch::Tensor& condition = {}) const;

    /// What predict_noise converts: the U-Net's own output, of the scheduler's prediction_type.
    torch::Tensor predict(const torch::Tensor& noisy_latents, const torch::Tensor& timesteps,
                          const TextEmbedding& text, const torch::Tensor& condition = {}) const;

    /// True with a second text encoder.
    bool is_sdxl() const { return !text_encoder_2.is_empty(); }
    int latent_channels() const;
    int condition_channels() const;  ///< in_channels - latent_channels (models/shape_condition.h)
    int downscale() const;           ///< image pixels a latent cell (4 or 8)
    torch::Device device() const;

    std::shared_ptr<ClipTokenizer> tokenizer;
    ClipTextModel text_encoder{nullptr};
    std::shared_ptr<ClipTokenizer> tokenizer_2;  ///< of SDXL, as is the encoder
    ClipTextModel text_encoder_2{nullptr};
    bool force_zeros_for_empty_prompt = false;
    UNet2DCondition unet{nullptr};
    std::shared_ptr<Autoencoder> vae;
    NoiseSchedule scheduler;
    ControlNet controlnet{nullptr};  ///< may be empty; see models/pipeline_extras.h
    double controlnet_scale = 1;

  private:
    std::map<std::string, TextEmbedding> encoded_;  ///< by keep_texts(), a row each

    void check_fit(const std::filesystem::path& folder) const;
    void check_tokenizers_fit(const std::filesystem::path& folder) const;
    void check_text_fit(const std::filesystem::path& folder) const;
    torch::Tensor sizes_of(const torch::Tensor& latents) const;
};

/// Puts convolution weights in the order that convolutions on channels-last maps want.
void use_channels_last(torch::nn::Module& module);

/// Parts of a pipeline's folder, each into a sub-folder that must exist; for trainings that write
/// one part after another. Weights are written as `dtype`.
void save_unet(const std::filesystem::path& folder, const UNet2DCondition& unet,
               torch::Dtype dtype = torch::kFloat16);
void save_autoencoder(const std::filesystem::path& folder, const Autoencoder& autoencoder,
                      torch::Dtype dtype = torch::kFloat16);
void save_clip_text(const std::filesystem::path& folder, const ClipTextModel& model,
                    torch::Dtype dtype = torch::kFloat16);

struct GenerateOptions {
    std::string prompt;
    std::optional<std::string> negative_prompt;  ///< without one: encode_no_text()
    std::string scheduler;  ///< a name of sampler_kinds(); empty: the folder's own
    int steps = 30;
    float guidance_scale = 7.5f;
    int width = 0;  ///< pixels, a multiple of downscale(); 0: the U-Net's sample_size
    int height = 0;
    int count = 1;
    std::uint64_t seed = 0;
    torch::Tensor latents;  ///< [count, C, h, w] standard normal to start from; empty: by seed
    /// [count, C, h, w] scaled latents of pictures to begin from instead of noise alone, and how
    /// much of the schedule is walked again: 1 forgets them, 0 leaves them (SDEdit, Meng et al.
    /// 2022).
    torch::Tensor image;
    double strength = 1;
    /// [1, 1, h, w] of 0 and 1. Where it is 1, `image` stays, and the rest is drawn to go with it
    /// (Avrahami et al. 2022, "Blended Diffusion"). Undefined: nothing stays.
    torch::Tensor keep;
    /// Of scheduler "ddim" alone. 1: fresh noise in each step, as DDPM; small priors draw more
    /// detail with it.
    double eta = 0;
    bool show_progress = true;
};

/// Sampling with classifier-free guidance; images [count, H, W, 3] in [0, 1] (sRGB).
/// condition: [1 or count, c, h, w], see predict_noise. Throws InputError for a size, a scheduler
/// or a number of steps that the model cannot do, Interrupted after Ctrl-C.
torch::Tensor generate(const Pipeline& pipeline, const GenerateOptions& options,
                       const torch::Tensor& condition = {});
/// The same up to the scaled latents [count, C, h, w], before decoding.
torch::Tensor generate_latents(const Pipeline& pipeline, const GenerateOptions& options,
                               const torch::Tensor& condition = {});

}  // namespace item3d
