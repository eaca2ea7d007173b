// Command item3d relight: shows a model in another light, which is changed by hand or by words.
#include "apps/item3d/edit/relight.h"

#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/image_options.h"
#include "apps/item3d/edit/model_options.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/version.h"
#include "item3d/io/gltf/light.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/io/overwrite.h"
#include "item3d/io/save.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/layout.h"
#include "item3d/lighting/presets/sky_hour.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/occlusion/occlusion.h"
#include "item3d/render/prefilter/image_based_light.h"
#include "item3d/render/render.h"
#include "item3d/render/textured_materials.h"
#include "item3d/report/animation.h"
#include "item3d/report/contact_sheet.h"
#include "item3d/report/display_image.h"
#include "item3d/report/model_images.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

namespace {

namespace fs = std::filesystem;

const Vec3 turntable_ground{0.898f, 0.890f, 0.871f};

/// Renderer of a model in one light, with self-shadowing.
class LitPainter {
  public:
    /// pixels: size of the largest images to be drawn.
    LitPainter(const Model& model, const Image& light, bool shadows, int pixels, at::Device device)
        : model_(model),
          geometry_(Geometry::from_model(model, device)),
          materials_(model, device),
          light_(prefilter(light, light_texels(pixels), device)) {
        if (!shadows) return;
        OcclusionOptions options;
        options.light = light;
        occlusion_ = std::make_shared<Occlusion>(geometry_, &model, options);
    }

    std::vector<Image> draw(int count, int pixels) const {
        const at::NoGradGuard no_grad;
        RenderOptions options;
        options.width = pixels;
        options.height = pixels;
        options.occlusion = occlusion_;
        std::vector<Image> images;
        // The first view is that of `item3d render`, which defines left and right.
        for (const Camera& camera : image_cameras(model_, count, default_azimuth)) {
            const at::Tensor image = render(geometry_, materials_, light_, {camera}, options);
            images.push_back(to_display(to_image(image[0].cpu())));
        }
        return images;
    }

  private:
    const Model& model_;
    Geometry geometry_;
    TexturedMaterials materials_;
    EnvironmentLight light_;
    std::shared_ptr<const Occlusion> occlusion_;
};

Image views_sheet(const std::vector<Image>& images, const std::string& title) {
    std::vector<Tile> tiles;
    for (const Image& image : images)
        tiles.push_back({image, ""});
    ContactSheetOptions options;
    options.columns = std::min<int>(3, static_cast<int>(tiles.size()));
    options.title = title;
    return contact_sheet(tiles, options);
}

/// Returns a contact sheet with a row for each light: the light itself, and up to three views.
Image comparison(const std::vector<Image>& before, const std::vector<Image>& after,
                 const Image& old_light, const Image& new_light, const std::string& title) {
    std::vector<Tile> tiles;
    const std::size_t views = std::min<std::size_t>(3, before.size());
    const auto add_row = [&](const Image& light, const std::vector<Image>& images,
                             const std::string& label) {
        tiles.push_back({light_image(light, images.front().width), label});
        for (std::size_t i = 0; i < views; ++i)
            tiles.push_back({images[i], ""});
    };
    add_row(old_light, before, "before");
    add_row(new_light, after, "after");
    ContactSheetOptions options;
    options.columns = static_cast<int>(views) + 1;
    options.title = title;
    return contact_sheet(tiles, options);
}

std::string light_title(const RelightCommand& options) {
    if (options.words.given()) return options.words.to;
    if (!options.change.lit.empty()) return options.change.lit;
    return options.sky ? fmt::format("the sky at {:g} o'clock", *options.sky)
                       : fs::path(options.light).stem().string();
}

Image chosen_light(const RelightCommand& options, const std::optional<SunSetting>& sun) {
    const Image base = options.sky
                           ? make_sky_at(*options.sky)
                           : load_light(options.light, parse_light_layout(options.change.layout));
    return apply(options.change, sun, base);
}

/// Draws the model under both lights and writes the images.
void write_images(const RelightCommand& options, const Model& model, const Image& old_image,
                  const Image& new_image, at::Device device) {
    const fs::path folder = options.output;
    const LitPainter old_painter(model, old_image, options.shadows, options.size, device);
    const LitPainter painter(model, new_image, options.shadows, options.size, device);
    const auto before = old_painter.draw(options.views, options.size);
    const auto after = painter.draw(options.views, options.size);
    const std::string title = light_title(options);
    save_image(folder / "before.png",
               views_sheet(before, fs::path(options.from_light).stem().string()));
    save_image(folder / "after.png", views_sheet(after, title));
    save_image(folder / "sheet.png", comparison(before, after, old_image, new_image, title));
    if (interrupted()) throw Interrupted("before the turntable was written");

    const int frame_size = std::max(16, options.size * 3 / 4);
    std::vector<Image> frames = painter.draw(options.frames, frame_size);
    for (Image& frame : frames)
        frame = flatten(frame, turntable_ground);
    write_atomically(folder / "turntable.webp",
                     std::span<const std::uint8_t>(encode_animation(frames)));
}

/// Returns the lights to be stored in model.glb. Viewers add up all lights, so a distinct brightest
/// lobe is removed from the surroundings.
ModelLights lights_for_model(const RelightCommand& options, const Image& light,
                             const LightLobe& lobe) {
    ModelLights lights;
    if (options.punctual) lights.sun = DirectionalLight{lobe.direction, Vec3(lobe.irradiance)};
    if (options.image_based) {
        lights.surroundings =
            make_image_based_light(options.punctual ? without_lobe(light, lobe) : light);
    }
    return lights;
}

/// Returns the provenance of a light. Only a light that the prior found counts as made by a
/// generative program.
Provenance provenance_of_light(const nlohmann::json& by_words,
                               std::shared_ptr<const SigningKey> key) {
    if (!by_words.is_object() || !by_words.contains("claim")) return {};
    return {{by_words["claim"].get<EditClaim>()}, std::move(key)};
}

}  // namespace

/// Throws for invalid combinations of options. A light found by guidance may be tinted and exposed.
/// All other changes set directions, which the sentence already sets.
void check_relight_options(const RelightCommand& options) {
    if (!options.words.given()) {
        if (options.words.resume || !options.words.overrides.empty() ||
            !options.words.prior.empty())
            throw UsageError(
                "--prior, --light-model, --guidance, --iterations, --seed and --resume require "
                "--from and --to");
        return;
    }
    const LightOptions& change = options.change;
    if (options.light_is_given || options.sky)
        throw UsageError(
            "--to cannot be combined with --light or --sky; leave out one of them (--from-light "
            "sets the initial light)");
    if (!change.sun.empty() || !change.lit.empty() || change.strength || change.rotation != 0 ||
        change.tilt != 0)
        throw UsageError(
            "--to describes the direction of the light; leave out --sun, --lit, --strength, "
            "--rotate and --tilt");
}

nlohmann::json perform_relight(const RelightCommand& options, EditSession& session) {
    check_relight_options(options);
    check_not_replaced(options.model, fs::path(options.output) / "model.glb");
    const std::shared_ptr<const SigningKey> key = options.sign_key.load();
    const at::Device device = start_command(options);
    const std::optional<SunSetting> placed_sun = chosen_sun(options.change);
    const Model model = load_model(options.model, {.texture_folders = options.texture_folders});
    const Image old_light = load_light(options.from_light);
    const fs::path folder = options.output;
    nlohmann::json by_words = nullptr;
    Image new_light;
    if (options.words.given()) {
        make_output_folder(folder);
        WordsLight found = light_by_words(options.words, options.model, options.from_light, folder,
                                          device, options.command, session);
        new_light = apply(options.change, placed_sun, found.light);
        by_words = std::move(found.record);
    } else {
        new_light = chosen_light(options, placed_sun);
    }
    const LightDescription description = describe_light(new_light);
    if (options.punctual && description.lobe.share == 0) {
        throw InputError("--punctual", "the light is black");
    }
    make_output_folder(folder);
    save_image(folder / "light.hdr", new_light, 32);
    save_image(folder / "light.exr", new_light, 32);
    write_images(options, model, old_light, new_light, device);

    nlohmann::json record = {{"version", version()},
                             {"command", options.command},
                             {"model", options.model},
                             {"from_light", options.from_light},
                             {"light", options.light},
                             {"sky", nullptr},
                             {"settings", settings_json(options.change, placed_sun)},
                             {"description", to_json(description)},
                             {"description_before", to_json(describe_light(old_light))},
                             {"words", by_words},
                             {"punctual", nullptr},
                             {"image_based", options.image_based}};
    if (options.sky || options.words.given()) record["light"] = nullptr;
    if (options.sky) record["sky"] = *options.sky;
    const ModelLights lights = lights_for_model(options, new_light, description.lobe);
    if (lights.sun) {
        const Vec3 from = lights.sun->direction, irradiance = lights.sun->irradiance;
        record["punctual"] = {{"direction", {from.x, from.y, from.z}},
                              {"irradiance", {irradiance.x, irradiance.y, irradiance.z}}};
    }
    save_lit_model(folder / "model.glb", model, lights, provenance_of_light(by_words, key));
    write_atomically(folder / "relight.json", std::string_view(record.dump(2) + "\n"));
    return record;
}

void add_relight_options(CLI::App& command, RelightCommand& options) {
    command.add_option("MODEL", options.model, "A " + model_extensions_text() + " file")
        ->required();
    command
        .add_option("-o,--output", options.output,
                    "Folder for the model, images before and after, and a turntable")
        ->type_name("FOLDER")
        ->required();
    add_texture_folders(command, options.texture_folders);
    CLI::Option* light =
        command
            .add_option("--light", options.light,
                        "New light: " + light_presets_text() + ", or an .hdr, .exr or .glb file")
            ->type_name("LIGHT")
            ->each([&options](const std::string&) { options.light_is_given = true; })
            ->capture_default_str();
    command
        .add_option("--sky", options.sky,
                    "New light: a clear sky at this hour. The sun rises in the east at 6 and is in "
                    "the south at 12")
        ->type_name("HOUR")
        ->check(number_between(0, 24))
        ->excludes(light);
    command.add_option("--from-light", options.from_light, "Old light, for the comparison")
        ->type_name("LIGHT")
        ->capture_default_str();
    add_light_options(command, options.change);
    add_words_options(command, options.words);
    add_sign_key(command, options.sign_key);
    command.add_flag("--punctual", options.punctual,
                     "Add the brightest part of the light to model.glb as a directional light "
                     "(KHR_lights_punctual)");
    command.add_flag("--image-based", options.image_based,
                     "Add the light to model.glb as an image-based light (EXT_lights_image_based); "
                     "with --punctual, without its brightest part");
    command.add_flag("!--no-shadows", options.shadows,
                     "Render without the shadows that the model casts on itself");
    command.add_option("--views", options.views, "Views in before.png and after.png")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    command.add_option("--frames", options.frames, "Frames of turntable.webp")
        ->check(CLI::Range(1, 360))
        ->capture_default_str();
    command.add_option("--size", options.size, "Edge length of a view, in pixels")
        ->check(CLI::Range(16, 2048))
        ->capture_default_str();
}

void add_relight_command(CLI::App& app) {
    auto options = std::make_shared<RelightCommand>();
    CLI::App* command = add_command(app, "relight", *options);
    add_relight_options(*command, *options);
    command->callback([options] {
        options->command = command_line();
        EditSession session;
        const nlohmann::json record = perform_relight(*options, session);
        if (options->json)
            print_json(record);
        else
            fmt::print("{}\n", (fs::path(options->output) / "sheet.png").string());
    });
}

}  // namespace item3d
