// Program parity CASE_DIR: computes the outputs of the reference libraries that a folder records,
// and compares them with the recorded ones. Prints one JSON object. Exit code: 0 if all outputs are
// within tolerance, 1 if not, 3 if the folder cannot be used.
#include "apps/parity/parity.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/tensors/process.h"

#include <cstdio>
#include <exception>

namespace item3d::parity {
namespace {

namespace fs = std::filesystem;

bool has_tokenizer(const fs::path& folder) {
    if (fs::exists(folder / "tokenizer_config.json")) return true;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_directory() && fs::exists(entry.path() / "tokenizer_config.json")) return true;
    return false;
}

/// Returns the class that config.json of a single model names, as diffusers or transformers write
/// it.
std::string class_of_config(const Config& config) {
    if (config.has("_class_name")) return config.text("_class_name", "");
    const auto names = config.texts("architectures", {});
    return names.empty() ? "" : names[0];
}

[[noreturn]] void reject(const fs::path& file, const std::string& found) {
    throw InputError(file.string(), "the class " + (found.empty() ? "(none)" : found) +
                                        " is not one that parity can check");
}

/// Detects the kind of the folder and runs its checker.
void check(Case& golden) {
    const fs::path& folder = golden.folder();
    if (fs::exists(folder / "config.json")) {
        const std::string name = class_of_config(Config::read(folder / "config.json"));
        golden.set_class(name);
        if (name == "UNet2DConditionModel") return check_unet(golden);
        if (name == "AutoencoderKL") return check_autoencoder_kl(golden);
        if (name == "AutoencoderTiny") return check_autoencoder_tiny(golden);
        if (name == "CLIPTextModel" || name == "CLIPTextModelWithProjection")
            return check_clip_text(golden);
        if (name == "CLIPModel") return check_clip_model(golden);
        if (name == "CLIPVisionModelWithProjection") return check_clip_vision(golden);
        if (name == "BlipForConditionalGeneration") return check_blip(golden);
        if (name == "Blip2ForConditionalGeneration") return check_blip2(golden);
        reject(folder / "config.json", name);
    }
    if (fs::exists(folder / "model_index.json")) {
        const std::string name = class_of_config(Config::read(folder / "model_index.json"));
        golden.set_class(name);
        if (name == "StableDiffusionPipeline" || name == "StableDiffusionXLPipeline")
            return check_pipeline(golden);
        reject(folder / "model_index.json", name);
    }
    if (fs::exists(folder / "controlnet" / "config.json")) {
        golden.set_class("ControlNetModel");
        return check_controlnet(golden);
    }
    if (fs::exists(folder / "plain" / "config.json") &&
        fs::exists(folder / "refined" / "config.json")) {
        golden.set_class("CLIPSegForImageSegmentation");
        return check_clip_seg(golden);
    }
    if (golden.has_meta()) {
        const Config meta = golden.meta();
        if (meta.has("kinds") && meta.has("configs")) {
            golden.set_class("schedulers");
            return check_schedulers(golden);
        }
        if (meta.has("pipeline") && golden.has("out.noisy_latents")) {
            golden.set_class("relative direction");
            return check_relative_direction(golden);
        }
        if (meta.has("files") && meta.has("lora_scales")) {
            golden.set_class("LoRA");
            return check_lora(golden);
        }
        if (meta.has("files") && meta.has("pipeline")) {
            golden.set_class("textual inversion");
            return check_textual_inversion(golden);
        }
        if (meta.has("texts") && has_tokenizer(folder)) {
            golden.set_class("CLIPTokenizer");
            return check_clip_tokenizer(golden);
        }
    }
    throw InputError(folder.string(),
                     "no config.json, model_index.json or meta.json says which "
                     "class to check");
}

int run(const fs::path& folder) {
    if (!fs::is_directory(folder))
        throw InputError(folder.string(), "no such folder", "name the folder of a case");
    Case golden(folder);
    const at::NoGradGuard no_grad;
    check(golden);
    fmt::print("{}\n", golden.report().dump(1));
    return golden.passed() ? 0 : 1;
}

}  // namespace
}  // namespace item3d::parity

int main(int argc, char** argv) {
    item3d::prepare_process();
    if (argc != 2) {
        fmt::print(stderr, "usage: parity CASE_DIR\n");
        return static_cast<int>(item3d::ExitCode::usage);
    }
    try {
        return item3d::parity::run(argv[1]);
    } catch (const item3d::Error& error) {
        fmt::print(stderr, "parity: {}\n", error.what());
        return static_cast<int>(error.code());
    } catch (const c10::Error& error) {
        // The recorded inputs have shapes that the network does not support.
        const std::string message = error.what_without_backtrace();
        fmt::print(stderr, "parity: {}: {}\n", argv[1], message.substr(0, message.find('\n')));
        return static_cast<int>(item3d::ExitCode::bad_input);
    } catch (const std::exception& error) {
        fmt::print(stderr, "parity: {}: {}\n", argv[1], error.what());
        return static_cast<int>(item3d::ExitCode::bad_input);
    }
}
