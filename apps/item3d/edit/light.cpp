// Command item3d light: converts, changes and describes lights.
#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/image_options.h"
#include "apps/item3d/edit/light_options.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/io/load_light.h"
#include "item3d/io/save.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/layout.h"

#include <filesystem>
#include <memory>
#include <string>

namespace item3d {

namespace {

namespace fs = std::filesystem;

struct LightCommand : CommonOptions {
    std::string light;
    std::string output;
    bool describe = false;
    LightOptions change;
};

constexpr int preview_width = 1024;

void write_light(const fs::path& path, const Image& light) {
    if (fs::is_directory(path)) {
        throw InputError(path.string(), "is a folder; expected a file name for the light",
                         "add a file name, such as light.hdr");
    }
    make_folder_of(path);
    if (lower_extension(path) == ".png") {
        save_image(path, light_image(light, std::min(preview_width, light.width)));
    } else {
        save_image(path, light, 32);
    }
}

void run_light(const LightCommand& options) {
    const std::string extension = lower_extension(options.output);
    if (!options.output.empty() && extension != ".hdr" && extension != ".exr" &&
        extension != ".png") {
        throw UsageError("-o " + options.output + ": expected a .hdr, .exr or .png file");
    }
    const LightOptions& change = options.change;
    const std::optional<SunSetting> sun = chosen_sun(change);
    const Image light =
        apply(change, sun, load_light(options.light, parse_light_layout(change.layout)));
    if (!options.output.empty()) write_light(options.output, light);

    const bool describe = options.describe || options.output.empty();
    if (options.json) {
        nlohmann::json result = to_json(describe_light(light));
        result.update({{"light", options.light},
                       {"width", light.width},
                       {"height", light.height},
                       {"settings", settings_json(change, sun)}});
        if (!options.output.empty()) result["file"] = options.output;
        print_json(result);
        return;
    }
    if (describe) fmt::print("{}", to_text(describe_light(light)));
    if (!options.output.empty()) fmt::print("{}\n", options.output);
}

}  // namespace

void add_light_command(CLI::App& app) {
    auto options = std::make_shared<LightCommand>();
    CLI::App* command = add_command(app, "light", *options);
    command->add_option("LIGHT", options->light, light_presets_text() + ", or an .hdr or .exr file")
        ->required();
    command
        ->add_option("-o,--output", options->output,
                     "Equirectangular .hdr or .exr, or a .png for viewing. Default: print a "
                     "description of the light")
        ->type_name("FILE");
    command->add_flag("--describe", options->describe,
                      "Print direction, colour and dynamic range of the light, even with -o");
    add_light_options(*command, options->change);
    command->callback([options] {
        start_command(*options);
        run_light(*options);
    });
}

}  // namespace item3d
