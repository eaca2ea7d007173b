// Command item3d caption: describes an image, or a model seen from all around, by a sentence.
#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/image_options.h"
#include "apps/item3d/edit/model_options.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/lighting/environment.h"
#include "item3d/networks/vision_language/captioner.h"
#include "item3d/render/image_tensor.h"
#include "item3d/report/display_image.h"
#include "item3d/report/model_images.h"
#include "item3d/tensors/precision.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

namespace {

struct CaptionCommand : CommonOptions {
    std::string input;
    std::string captioner;
    std::string precision = "auto";
    std::string light = "studio";
    int views = 4;
    std::vector<std::filesystem::path> texture_folders;
    CaptionOptions caption{.prefix = {}, .beams = caption_beams};
};

constexpr int caption_view_pixels = 512;
constexpr int min_pixels = 8;  ///< minimum side of an image

at::Tensor to_bytes(const at::Tensor& image) {
    return (image.nan_to_num(0).clamp(0, 1) * 255).round().to(at::kByte);
}

/// Loads the images to be captioned, as bytes [H, W, C] each. There is one image, or one for each
/// view of a model.
std::vector<at::Tensor> load_images(const CaptionCommand& options, at::Device device) {
    const std::string extension = lower_extension(options.input);
    if (!is_model_file(options.input)) {
        const Image image = load_image(options.input);
        if (std::min(image.width, image.height) < min_pixels)
            throw InputError(
                options.input,
                fmt::format("an image of {} x {} pixels is too small", image.width, image.height),
                fmt::format("use an image of at least {0} x {0}", min_pixels));
        const bool linear = extension == ".exr" || extension == ".hdr";
        return {to_bytes(to_tensor(linear ? to_display(image) : image))};
    }
    const Model model = load_model(options.input, {.texture_folders = options.texture_folders});
    const EnvironmentLight light = prefilter(load_light(options.light), 256, device);
    const at::Tensor views = over_white(
        draw_images(model, light, image_cameras(model, options.views), caption_view_pixels));
    std::vector<at::Tensor> images;
    for (const at::Tensor& view : views.cpu().unbind(0))
        images.push_back(to_bytes(view.permute({1, 2, 0})));
    return images;
}

void run_caption(const CaptionCommand& options, at::Device device) {
    const std::unique_ptr<Captioner> captioner =
        load_captioner(options.captioner, device, choose_precision(options.precision, device));
    const std::vector<at::Tensor> images = load_images(options, device);

    const auto begin = std::chrono::steady_clock::now();
    const std::string caption = captioner->caption_together(images, options.caption);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    if (options.json) {
        // Captions of single views show where the views disagree.
        nlohmann::json of_views = nlohmann::json::array();
        if (images.size() == 1) {
            of_views.push_back(caption);
        } else {
            for (const Caption& alone : captioner->captions(images, options.caption))
                of_views.push_back(alone.text);
        }
        print_json({{"file", options.input},
                    {"captioner", options.captioner},
                    {"prefix", options.caption.prefix},
                    {"beams", options.caption.beams},
                    {"caption", caption},
                    {"of_views", of_views},
                    {"seconds", took.count()}});
    } else {
        fmt::print("{}\n", caption);
    }
}

}  // namespace

void add_caption_command(CLI::App& app) {
    auto options = std::make_shared<CaptionCommand>();
    CLI::App* command = add_command(app, "caption", *options);
    command
        ->add_option("IMAGE|MODEL", options->input,
                     "A .png, .jpg, .hdr or .exr image, or a " + model_extensions_text() + " model")
        ->required();
    add_texture_folders(*command, options->texture_folders);
    command
        ->add_option("--captioner", options->captioner,
                     "BLIP or BLIP-2 (OPT) in the transformers layout. Default: the embedded "
                     "prior's captioner")
        ->type_name("FOLDER");
    command->add_option("--prefix", options->caption.prefix,
                        "Start of the caption, such as \"a photo of\"");
    command->add_option("--beams", options->caption.beams, "Beams of the beam search; 1: greedy")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command
        ->add_option("--max-tokens", options->caption.max_new_tokens,
                     "Maximum number of tokens after the prefix")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        ->add_option("--views", options->views,
                     "Views around a model that the caption is made from")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command
        ->add_option("--light", options->light,
                     "Light on a model: " + light_presets_text() + ", or an .hdr or .exr file")
        ->type_name("LIGHT")
        ->capture_default_str();
    command
        ->add_option("--precision", options->precision,
                     "Precision of the networks: auto, fp32, bf16")
        ->capture_default_str();
    command->callback([options] {
        const at::Device device = start_command(*options);
        options->captioner = given_or_embedded(options->captioner, "captioner", "--captioner");
        run_caption(*options, device);
    });
}

}  // namespace item3d
