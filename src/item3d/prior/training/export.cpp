#include "item3d/prior/training/export.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/pipeline_folder.h"
#include "item3d/prior/data/materials/materials.h"
#include "item3d/prior/data/prior_folder.h"

#include <set>

namespace item3d {
namespace {

namespace fs = std::filesystem;

void write_json(const fs::path& path, const nlohmann::json& json) {
    write_atomically(path, json.dump(2) + "\n");
}

nlohmann::json model_index() {
    const auto of = [](const char* library, const char* name) {
        return nlohmann::json::array({library, name});
    };
    return {{"_class_name", "StableDiffusionPipeline"},
            {"scheduler", of("diffusers", "DDIMScheduler")},
            {"text_encoder", of("transformers", "CLIPTextModel")},
            {"tokenizer", of("transformers", "CLIPTokenizer")},
            {"unet", of("diffusers", "UNet2DConditionModel")},
            {"vae", of("diffusers", "AutoencoderTiny")},
            {"safety_checker", nlohmann::json::array({nullptr, nullptr})},
            {"feature_extractor", nlohmann::json::array({nullptr, nullptr})},
            {"requires_safety_checker", false}};
}

}  // namespace

void export_autoencoder(const fs::path& folder, const AutoencoderTiny& autoencoder,
                        const ClipTokenizer& tokenizer) {
    for (const char* part : {"tokenizer", "vae"})
        make_output_folder(folder / part);
    tokenizer.save(folder / "tokenizer");
    save_autoencoder(folder / "vae", autoencoder);
    write_json(folder / "model_index.json", model_index());
}

namespace {

/// Words for materials and patterns with fine structure, which guidance averages away and sampling
/// reproduces. Metals are not among them: sampling made a golden vase worse (docs/benchmarks.md).
std::vector<std::string> detail_words() {
    std::set<std::string> structured{
        "wood",        "oak",   "walnut", "pine", "bamboo", "marble", "stone", "granite",
        "cobblestone", "brick", "grass",  "moss", "lava",   "cheese", "rust",  "porcelain"};
    std::vector<std::string> words;
    for (const MaterialWord& word : material_words())
        if (structured.erase(word.word) > 0 || word.group == "patterns")
            words.insert(words.end(), word.spellings.begin(), word.spellings.end());
    ITEM3D_CHECK(structured.empty(), "a material with structure that is not in the vocabulary");
    return words;
}

/// Returns the default edit settings of a prior of this size. `item3d edit` reads them from
/// prior.json.
nlohmann::json edit_defaults(int resolution) {
    return {{"guidance", "rdl"},
            {"adjust", "learned"},
            {"cfg", 7.5},
            {"adjust_learning_rate", 0.06},
            {"adjust_samples", 4},
            {"iterations", 250},
            {"iterations_before_detail", 120},
            {"settle", 0.5},
            {"batch", 1},
            {"resolution", resolution},
            {"learning_rate", 0.005},
            {"evenness", 1000},
            {"metallic_start", 0.9},
            {"timesteps", {0.02, 0.98}},
            {"weighting", "dreamfusion"},
            {"light", "studio"},
            {"background", "vary"},
            {"detail_words", detail_words()},
            {"keep", {"occlusion", "normal"}}};
}

}  // namespace

void export_diffusion(const fs::path& folder, const UNet2DCondition& unet,
                      const ClipTextModel& text, const SchedulerConfig& scheduler, int resolution,
                      const nlohmann::json& train) {
    for (const char* part : {"unet", "text_encoder", "scheduler"})
        make_output_folder(folder / part);
    write_json(folder / "scheduler" / "scheduler_config.json", scheduler.to_json());
    save_unet(folder / "unet", unet);
    save_clip_text(folder / "text_encoder", text);

    update_prior_json(folder, {{"name", "item3d embedded prior"},
                               {"resolution", resolution},
                               {"train", train},
                               {"defaults", edit_defaults(resolution)},
                               // Stronger guidance oversaturates the small prior's colours.
                               {"generate", {{"steps", 30}, {"guidance_scale", 3.5}}}});
}

}  // namespace item3d
