#include "item3d/networks/diffusion/running_pipeline.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/diffusion_networks.h"
#include "item3d/networks/diffusion/pipeline_folder.h"
#include "item3d/networks/layers/load_parameters.h"

#include <malloc.h>

#include <algorithm>
#include <set>

namespace item3d {
namespace {

/// Returns the embedding of each prompt, and that of no text.
std::map<std::string, TextEmbedding> encode_each(const TextEncoders& text,
                                                 const std::vector<std::string>& prompts) {
    std::set<std::string> distinct(prompts.begin(), prompts.end());
    distinct.emplace();
    // Encodes one prompt at a time, because rounding must not depend on the other prompts.
    std::map<std::string, TextEmbedding> encoded;
    for (const std::string& prompt : distinct)
        encoded[prompt] = text.encode({prompt});
    return encoded;
}

void release_convolution_weights(const DiffusionNetworks& networks) {
    std::vector<std::shared_ptr<torch::nn::Module>> all{networks.unet.ptr(), networks.vae};
    if (!networks.controlnet.is_empty()) all.push_back(networks.controlnet.ptr());
    for (const auto& network : all)
        for (const auto& layer : network->modules())
            if (auto* convolution = layer->as<Conv3x3>()) convolution->release_weights();
}

}  // namespace

RunningPipeline RunningPipeline::load(const std::filesystem::path& folder, at::Device device,
                                      at::ScalarType dtype, const PipelineExtras& extras,
                                      const RunNeeds& needs) {
    const PipelineIndex index = PipelineIndex::read(folder);
    RunningPipeline pipeline;
    pipeline.folder_ = folder;
    pipeline.extras_ = extras;
    pipeline.sdxl_ = index.has_second_text_encoder;
    pipeline.force_zeros_for_empty_prompt_ = index.force_zeros_for_empty_prompt;
    {
        TextEncoders text = TextEncoders::load(folder, index.has_second_text_encoder, device);
        pipeline.tokenizer_ = text.tokenizer;
        const auto load_networks = [&](WeightUse use) {
            pipeline.networks_ = std::make_shared<DiffusionNetworks>(
                DiffusionNetworks::load(folder, text, device, dtype, needs.decoder, use));
        };
        if (!extras.lora.empty()) {
            load_networks(WeightUse::any);
            fuse_loras(extras, text, *pipeline.networks_);
        }
        add_embeddings(extras, text);
        pipeline.encoded_ = encode_each(text, needs.prompts);
        text.release_weights();
        // Freed blocks are fragmented; malloc_trim returns whole pages to the system.
        malloc_trim(0);
        if (extras.lora.empty()) load_networks(WeightUse::running);
    }
    change_networks(extras, *pipeline.networks_, needs.decoder);
    release_convolution_weights(*pipeline.networks_);
    malloc_trim(0);
    return pipeline;
}

bool RunningPipeline::knows_prompts(const std::vector<std::string>& prompts) const {
    return std::all_of(prompts.begin(), prompts.end(),
                       [&](const std::string& prompt) { return encoded_.contains(prompt); });
}

void RunningPipeline::learn_prompts(const std::vector<std::string>& prompts) {
    if (knows_prompts(prompts)) return;
    ITEM3D_CHECK(can_learn_prompts(), "text encoders with a LoRA are loaded with the U-Net");
    std::vector<std::string> unknown;
    for (const std::string& prompt : prompts)
        if (!encoded_.contains(prompt)) unknown.push_back(prompt);
    TextEncoders text = TextEncoders::load(folder_, sdxl_, device());
    add_embeddings(extras_, text);
    encoded_.merge(encode_each(text, unknown));
    text.release_weights();
    malloc_trim(0);
}

RunningPipeline RunningPipeline::renewed() const {
    RunningPipeline other;  // with its own count of predicted rows
    other.tokenizer_ = tokenizer_;
    other.networks_ = networks_;
    other.sdxl_ = sdxl_;
    other.force_zeros_for_empty_prompt_ = force_zeros_for_empty_prompt_;
    other.folder_ = folder_;
    other.extras_ = extras_;
    other.encoded_ = encoded_;
    return other;
}

TextEmbedding RunningPipeline::encode_text(const std::vector<std::string>& prompts) const {
    TextEmbedding known;
    for (const std::string& prompt : prompts) {
        const auto found = encoded_.find(prompt);
        ITEM3D_CHECK(found != encoded_.end(),
                     "'" + prompt + "' was not encoded before the text encoder was released");
        known = known.states.defined() ? TextEmbedding::join(known, found->second) : found->second;
    }
    return known;
}

}  // namespace item3d
