#include "item3d/networks/verify.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/networks/diffusion/autoencoder.h"
#include "item3d/networks/diffusion/noise_schedule.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/layers/packable_linear.h"
#include "item3d/networks/vision_language/captioner.h"
#include "item3d/networks/vision_language/clip.h"
#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/networks/vision_language/segmenter.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/weights.h"
#include "item3d/text/clip_tokenizer.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Parts that item3d uses, with the supported classes. Others (safety checkers, feature extractors,
/// depth estimators) are ignored.
struct KnownPart {
    const char* name;
    std::vector<std::string> classes;  ///< any class if empty
    bool required;
};
const KnownPart known_parts[] = {
    {"tokenizer", {"CLIPTokenizer", "CLIPTokenizerFast"}, true},
    {"text_encoder", {"CLIPTextModel"}, true},
    {"tokenizer_2", {"CLIPTokenizer", "CLIPTokenizerFast"}, false},
    {"text_encoder_2", {"CLIPTextModelWithProjection"}, false},
    {"unet", {"UNet2DConditionModel"}, true},
    {"vae", {"AutoencoderKL", "AutoencoderTiny"}, true},
    {"scheduler", {}, true},
};

/// Networks for scores, captions and masks, which model_index.json does not list.
const std::string parts_beside[] = {"clip", "captioner", "segmenter"};

/// Returns the class of a part in model_index.json; "" for none.
std::string class_of(const Config& index, const std::string& part) {
    if (!index.has(part)) return "";
    const auto& entry = index.json().at(part);
    return entry.is_array() && entry.size() == 2 && entry[1].is_string()
               ? entry[1].get<std::string>()
               : "";
}

std::int64_t count_parameters(const torch::nn::Module& module) {
    std::int64_t count = 0;
    for (const at::Tensor& parameter : module.parameters())
        count += parameter.numel();
    return count;
}

/// Returns the type's name in the option --precision ("fp16").
std::string name_of(at::ScalarType dtype) {
    if (dtype == at::kFloat) return "fp32";
    if (dtype == at::kHalf) return "fp16";
    if (dtype == at::kBFloat16) return "bf16";
    return c10::toString(dtype);
}

/// Counts of the numbers that networks keep for gradients: the VAE's encoder for one image, and the
/// U-Net for the latents of one image (an edit differentiates through both). Each member is a sum
/// over levels: kept tensors per residual block, times blocks, channels and pixels.
struct KeptNumbers {
    double encoder = 0;
    double unet = 0;
};

KeptNumbers count_kept(const UNet2DConditionConfig& unet, const nlohmann::json& vae, int resolution,
                       int downscale) {
    // These constants are fitted to the memory of guidance steps with Stable Diffusion 1.5's layout
    // in bf16 on the CPU, temporaries included. An image takes 0.83 GB at 512 pixels and 0.21 GB at
    // 256. A gradient through the U-Net takes 0.23 GB more at 256.
    constexpr double kept_by_encoder_block = 3.5;
    constexpr double kept_by_block = 4;
    constexpr double kept_by_transformer = 37;
    KeptNumbers kept;
    const bool tiny = vae.contains("encoder_block_out_channels");
    const std::vector<int> channels =
        vae.at(tiny ? "encoder_block_out_channels" : "block_out_channels").get<std::vector<int>>();
    double pixels = double(resolution) * resolution;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const double blocks = tiny ? vae.at("num_encoder_blocks").at(i).get<double>()
                                   : vae.at("layers_per_block").get<double>();
        kept.encoder += kept_by_encoder_block * blocks * channels[i] * pixels;
        pixels /= 4;
    }
    double cells = double(resolution) / downscale * resolution / downscale;
    for (std::size_t i = 0; i < unet.block_out_channels.size(); ++i) {
        // The down path has layers_per_block blocks at each level, the up path one more.
        const double blocks = 2 * unet.layers_per_block[i] + 1;
        const bool attends = unet.down_block_types[i].find("CrossAttn") != std::string::npos;
        const double transformers = attends ? unet.transformer_layers_per_block[i] : 0;
        kept.unet += blocks * (kept_by_block + kept_by_transformer * transformers) *
                     unet.block_out_channels[i] * cells;
        cells /= 4;
    }
    return kept;
}

class Verification {
  public:
    explicit Verification(const fs::path& folder)
        : folder_(folder), index_(Config::read(folder / "model_index.json")) {
        report_.folder = folder.string();
        report_.pipeline_class = index_.text("_class_name", "");
    }

    PriorReport run() {
        for (const KnownPart& known : known_parts)
            look_at(known);
        for (const std::string& name : parts_beside)
            look_beside(name);
        attempt([&] { check_fit(); });
        if (report_.usable()) add_memory();
        return std::move(report_);
    }

  private:
    /// Runs `action` and adds its error to the problems.
    template <typename Action>
    void attempt(const Action& action) {
        try {
            action();
        } catch (const Error& error) {
            report_.problems.push_back(error.what());
        }
    }

    void look_at(const KnownPart& known) {
        PartReport part;
        part.name = known.name;
        part.class_name = class_of(index_, known.name);
        if (part.class_name.empty()) {
            if (known.required)
                attempt([&] { index_.reject(known.name, "is missing, but edits need it"); });
            return;
        }
        const auto& classes = known.classes;
        if (!classes.empty() &&
            std::find(classes.begin(), classes.end(), part.class_name) == classes.end())
            attempt([&] {
                index_.reject(known.name, fmt::format("{} is not supported (expected {})",
                                                      part.class_name, fmt::join(classes, " or ")));
            });
        else
            attempt([&] { read(part); });
        report_.parts.push_back(std::move(part));
    }

    void read(PartReport& part) {
        const fs::path folder = folder_ / part.name;
        if (!fs::is_directory(folder))
            throw InputError(folder.string(), "no such folder, but model_index.json names it",
                             "download the prior again");
        if (part.name.starts_with("tokenizer")) {
            const ClipTokenizer tokenizer = ClipTokenizer::load(folder);
            if (part.name == "tokenizer") tokenizer_ = tokenizer;
            return;
        }
        if (part.name == "scheduler") {
            report_.prediction_type = NoiseSchedule::load(folder).config().prediction_type;
            return;
        }
        if (part.name == "unet") {
            const UNet2DCondition unet = load_unet(folder, at::kMeta);
            unet_ = unet->config();
            describe_weights(part, *unet);
        } else if (part.name == "vae") {
            vae_ = load_autoencoder(folder, at::kMeta);
            describe_weights(part, *vae_);
        } else {
            const ClipTextModel text = load_clip_text(folder, at::kMeta);
            text_.push_back(text->config());
            describe_weights(part, *text);
        }
    }

    /// Checks one of parts_beside, if the prior has it.
    void look_beside(const std::string& name) {
        const fs::path folder = folder_ / name;
        if (!fs::exists(folder / "config.json")) return;
        PartReport part;
        part.name = name;
        attempt([&] {
            const auto classes = Config::read(folder / "config.json").texts("architectures", {});
            if (!classes.empty()) part.class_name = classes.front();
            if (name == "clip")
                Clip::load(folder, at::kMeta);
            else if (name == "segmenter")
                Segmenter::load(folder, at::kMeta);
            else
                load_captioner(folder, at::kMeta);
            part.parameters = describe_weights(part).total_elements();
        });
        report_.parts.push_back(std::move(part));
    }

    void describe_weights(PartReport& part, const torch::nn::Module& module) {
        part.parameters = count_parameters(module);
        describe_weights(part);
    }

    /// Sets the stored types and the file size of `part`. Returns its weights.
    Weights describe_weights(PartReport& part) {
        const char* stem =
            part.name == "unet" || part.name == "vae" ? "diffusion_pytorch_model" : "model";
        Weights weights = Weights::open(folder_ / part.name, stem);
        std::set<std::string> types;
        for (const std::string& name : weights.names()) {
            const TensorInfo info = weights.info(name);
            std::uint64_t bytes = at::elementSize(info.dtype);
            for (const std::int64_t extent : info.shape)
                bytes *= static_cast<std::uint64_t>(extent);
            types.insert(name_of(info.dtype));
            part.file_bytes += bytes;
        }
        part.stored_as = fmt::format("{}", fmt::join(types, ", "));
        return weights;
    }

    /// Finds parts that are valid alone but belong to different models.
    void check_fit() {
        if (!unet_) return;
        const std::string file = (folder_ / "unet" / "config.json").string();
        const std::string hint = "the folder contains parts of different models";
        if (vae_) {
            const int latent = vae_->latent_channels();
            report_.resolution = unet_->sample_size * vae_->downscale();
            report_.condition_channels = unet_->in_channels - latent;
            if (unet_->out_channels != latent || unet_->in_channels < latent)
                throw InputError(file,
                                 fmt::format("{} to {} channels do not fit the VAE's {} latent "
                                             "channels",
                                             unet_->in_channels, unet_->out_channels, latent),
                                 hint);
        }
        int width = 0;
        for (const ClipTextConfig& text : text_)
            width += text.hidden_size;
        const auto& wanted = unet_->cross_attention_dim;
        if (!text_.empty() &&
            std::any_of(wanted.begin(), wanted.end(), [&](int one) { return one != width; }))
            throw InputError(file,
                             fmt::format("cross_attention_dim is {}, but the text encoder has {}",
                                         wanted.front(), width),
                             hint);
        if (!text_.empty() && tokenizer_ && tokenizer_->largest_id() >= text_.front().vocab_size)
            throw InputError((folder_ / "text_encoder" / "config.json").string(),
                             fmt::format("vocab_size is {}, but the tokenizer has an id {}",
                                         text_.front().vocab_size, tokenizer_->largest_id()),
                             hint);
        if (report_.condition_channels > 1 &&
            report_.condition_channels != surface_condition_channels)
            throw InputError(file,
                             fmt::format("its {} additional input channels (for inpainting or "
                                         "image editing) are not supported",
                                         report_.condition_channels),
                             "use a text-to-image or depth-to-image model");
    }

    void add_memory() {
        // LibTorch takes 0.2 GB; the rest is for the model, its textures and the renderer.
        constexpr double program_bytes = 0.5e9;
        // Additional memory of packed convolutions, as a fraction of the weights. It was measured
        // in fp32 and bf16 on the steps to which count_kept() is fitted. In fp32, most weights of
        // an fp16 file stay fp16.
        constexpr double packed_float = 0.12, packed_half = 0.1, bytes_of_halves = 2.8;
        const bool halves =
            PackedMatrix::runs(at::kCPU, at::kHalf) &&
            std::any_of(report_.parts.begin(), report_.parts.end(), [](const PartReport& part) {
                return part.name == "unet" && part.stored_as == "fp16";
            });
        const KeptNumbers kept =
            count_kept(*unet_, vae_->config_json(), report_.resolution, vae_->downscale());
        for (const auto& [name, size] : {std::pair("fp32", 4), {"bf16", 2}, {"fp16", 2}}) {
            MemoryReport memory;
            memory.precision = name;
            for (const PartReport& part : report_.parts) {
                if (std::find(std::begin(parts_beside), std::end(parts_beside), part.name) !=
                    std::end(parts_beside))
                    continue;  // loaded on demand
                const bool text = part.name.starts_with("text");
                const double each = text ? 4 : size == 4 && halves ? bytes_of_halves : size;
                const auto bytes =
                    static_cast<std::uint64_t>(each * static_cast<double>(part.parameters));
                memory.weights += bytes;
                if (text) memory.text_encoders += bytes;
            }
            const double packed = size != 4 ? packed_half : halves ? 0 : packed_float;
            memory.program = static_cast<std::uint64_t>(
                program_bytes +
                packed * static_cast<double>(memory.weights - memory.text_encoders));
            memory.kept_by_gradients =
                static_cast<std::uint64_t>((kept.encoder + kept.unet) * size);
            // Recomputation keeps the input of each of the encoder's residual blocks, and all
            // activations of one block.
            memory.kept_when_low =
                static_cast<std::uint64_t>((0.4 * kept.encoder + kept.unet) * size);
            report_.memory.push_back(memory);
        }
    }

    fs::path folder_;
    Config index_;
    PriorReport report_;
    std::optional<ClipTokenizer> tokenizer_;
    std::vector<ClipTextConfig> text_;
    std::optional<UNet2DConditionConfig> unet_;
    std::shared_ptr<Autoencoder> vae_;
};

}  // namespace

std::int64_t PriorReport::parameters() const {
    return std::accumulate(
        parts.begin(), parts.end(), std::int64_t(0),
        [](std::int64_t sum, const PartReport& part) { return sum + part.parameters; });
}

PriorReport verify_prior(const fs::path& folder) {
    if (!fs::is_directory(folder))
        throw InputError(folder.string(), "no such folder",
                         "give a folder in the diffusers layout (with model_index.json)");
    return Verification(folder).run();
}

}  // namespace item3d
