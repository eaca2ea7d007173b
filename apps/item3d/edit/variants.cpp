// Command item3d variants: writes several edits of a model as variants in one file.
#include "item3d/io/variants.h"

#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/model_options.h"
#include "apps/item3d/sign_key_option.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/io/load.h"

#include <memory>
#include <string>

namespace item3d {
namespace {

struct VariantsCommand : CommonOptions {
    VariantsRequest request;
    std::string provenance = "on";
    SignKeyOption sign_key;
};

void run_variants(VariantsCommand& options) {
    VariantsRequest& request = options.request;
    request.says_provenance = options.provenance == "on";
    if (!request.says_provenance && !options.sign_key.path.empty())
        throw UsageError(
            "--sign-key cannot be used with --provenance off, which writes nothing to sign");
    request.sign_key = options.sign_key.load();
    start_command(options);
    const nlohmann::json record = write_variants(request);
    if (options.json) {
        print_json(record);
        return;
    }
    for (const nlohmann::json& variant : record["variants"])
        fmt::print("{}\n", variant["name"].get<std::string>());
}

}  // namespace

void add_variants_command(CLI::App& app) {
    auto options = std::make_shared<VariantsCommand>();
    CLI::App* command = add_command(app, "variants", *options);
    VariantsRequest& request = options->request;
    command
        ->add_option("MODEL", request.model,
                     "The model that was edited: " + model_extensions_text())
        ->required();
    command->add_option("EDIT_DIR", request.edits, "Output folders of item3d edit, of this model")
        ->required();
    command->add_option("-o,--output", request.output, "Model to write: .glb or .gltf")
        ->type_name("FILE")
        ->required();
    command
        ->add_option("--name", request.names,
                     "Name of a variant, given once for each EDIT_DIR in their order. Default: the "
                     "target sentence without its article")
        ->type_name("NAME")
        ->allow_extra_args(false);
    command
        ->add_option("--original", request.original,
                     "Name of the variant with the model's own look. Default: \"original\", or "
                     "none if the model already has variants")
        ->type_name("NAME");
    add_texture_folders(*command, request.texture_folders);
    command
        ->add_option("--provenance", options->provenance,
                     "on: the file records the edits that it was made from; off: it does not")
        ->check(CLI::IsMember({"on", "off"}))
        ->capture_default_str();
    add_sign_key(*command, options->sign_key);
    command->footer("Viewers show the model's own look first and offer the variants by name.");
    command->callback([options] { run_variants(*options); });
}

}  // namespace item3d
