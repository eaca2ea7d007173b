// Command item3d region: shows the region of selectors before an edit.
#include "item3d/region/region.h"

#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/image_options.h"
#include "apps/item3d/edit/model_options.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/material_source.h"
#include "item3d/field/atlas/atlas.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/file_names.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/io/part_names.h"
#include "item3d/io/save.h"
#include "item3d/networks/diffusion/running_pipeline.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/region/masks.h"
#include "item3d/region/preview.h"
#include "item3d/region/region_readers.h"
#include "item3d/render/image_tensor.h"
#include "item3d/report/animation.h"
#include "item3d/report/contact_sheet.h"
#include "item3d/report/display_image.h"
#include "item3d/report/model_images.h"

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int view_count = 6;

struct RegionCommand : CommonOptions {
    std::string model;
    RegionRequest request;
    std::vector<std::string> materials;
    std::vector<fs::path> texture_folders;
    fs::path segmenter;
    std::string prior;     ///< folder or name, see find_prior()
    std::string from, to;  ///< for auto
    std::string output;
    int size = 384;
    int texture_size = 0;
};

/// Returns the names in the file that selectors can use.
json names_of(const Model& model) {
    std::set<std::string> materials, nodes, meshes, groups;
    for (const Primitive& primitive : model.primitives) {
        materials.insert(model.materials[static_cast<std::size_t>(primitive.material)].name);
        for (const std::string& name : node_names(model, primitive))
            nodes.insert(name);
        meshes.insert(mesh_name(model, primitive));
    }
    for (const auto& names : model.groups)
        groups.insert(names.begin(), names.end());
    json names = json::object();
    const auto add = [&](const char* kind, std::set<std::string> found) {
        found.erase("");
        if (!found.empty()) names[kind] = found;
    };
    add("material", std::move(materials));
    add("node", std::move(nodes));
    add("mesh", std::move(meshes));
    add("group", std::move(groups));
    const std::vector<std::string> attributes = vertex_attribute_names(model);
    if (!attributes.empty()) names["attribute"] = attributes;
    return names;
}

/// Prints the names. record: content of region.json.
void print_names(const json& record) {
    const auto bounds = record["bounds"].get<std::array<std::array<float, 3>, 2>>();
    fmt::print("box: {:.4g} (minimum, then maximum of x, y and z in the file)\n",
               fmt::join(std::array{bounds[0][0], bounds[0][1], bounds[0][2], bounds[1][0],
                                    bounds[1][1], bounds[1][2]},
                         ","));
    for (const auto& [kind, list] : record["names"].items()) {
        const std::size_t shown = std::min<std::size_t>(list.size(), 12);
        std::string line;
        for (std::size_t i = 0; i < shown; ++i)
            line += (i > 0 ? ", " : "") + list[i].get<std::string>();
        fmt::print("{}: {}{}\n", kind, line,
                   list.size() > shown
                       ? fmt::format(" and {} more (--json lists all)", list.size() - shown)
                       : "");
    }
}

/// Saves the cameras of the views, so that masks painted on the views can be used as selectors:
/// view=PICTURE@transforms.json#view_0.
void save_cameras(const fs::path& path, const std::vector<Camera>& cameras, const Model& model) {
    json document{{"camera_angle_x", cameras.front().field_of_view_x}, {"frames", json::array()}};
    for (const Camera& camera : cameras) {
        json rows = json::array();
        for (int row = 0; row < 4; ++row) {
            json values = json::array();
            for (int column = 0; column < 4; ++column) {
                double value = camera.camera_to_world[column][row];
                if (column == 3 && row < 3) value += model.origin[row];
                values.push_back(value);
            }
            rows.push_back(std::move(values));
        }
        document["frames"].push_back(
            {{"file_path", "./" + camera.name}, {"transform_matrix", std::move(rows)}});
    }
    write_atomically(path, std::string_view(document.dump(2)));
}

RegionReaders load_wanted_readers(const RegionCommand& options, at::Device device) {
    const RegionRequest& request = options.request;
    if (!request.needs_segmenter() && !request.needs_sentences()) return {};
    const fs::path prior =
        request.needs_sentences() || options.segmenter.empty() ? find_prior(options.prior) : "";
    const fs::path segmenter =
        options.segmenter.empty() ? find_in_prior(prior, "segmenter") : options.segmenter;
    RegionReaders readers = load_readers(request, segmenter, prior, device);
    if (!needs_prior(request, readers.segmenter != nullptr)) return readers;
    RunNeeds needs;
    needs.decoder = false;
    if (request.needs_sentences()) {
        const PriorVocabulary vocabulary = PriorVocabulary::load(prior);
        for (const std::string& sentence : {options.from, options.to}) {
            const std::string warning = vocabulary.warning(sentence, /*shape_is_given=*/true);
            if (!warning.empty()) warn(warning);
        }
        readers.from = vocabulary.reading(options.from);
        readers.to = vocabulary.reading(options.to);
        needs.prompts = {readers.from, readers.to};
    }
    if (!readers.segmenter)
        for (const std::string& prompt : prompts_of_words(request))
            needs.prompts.push_back(prompt);
    readers.prior = std::make_shared<RunningPipeline>(
        RunningPipeline::load(prior, device, at::kFloat, {}, needs));
    return readers;
}

class RegionOutput {
  public:
    RegionOutput(const RegionCommand& options, at::Device device)
        : options_(options),
          folder_(options.output),
          model_(load_model(options.model, {.texture_folders = options.texture_folders})),
          geometry_(Geometry::from_model(model_, device)),
          textured_(model_, device),
          light_(prefilter(load_light("studio"), light_texels(options.size), device)),
          cameras_(image_cameras(model_, view_count)) {
        for (std::size_t i = 0; i < cameras_.size(); ++i)
            cameras_[i].name = fmt::format("view_{}", i);
    }

    json write() {
        const auto [low, high] = model_.bounds();
        const Vec3 origin(model_.origin);
        const auto numbers = [](Vec3 v) { return json{v.x, v.y, v.z}; };
        json record{{"model", options_.model},
                    {"names", names_of(model_)},
                    {"bounds", {numbers(low + origin), numbers(high + origin)}}};
        // Unusable selectors are reported before anything is written.
        const std::vector<int> materials = select_materials(model_, options_.materials);
        const FieldSpace space(model_, materials, geometry_.positions.device());
        std::unique_ptr<Region> region;
        const RegionReaders readers = load_wanted_readers(options_, geometry_.positions.device());
        if (!options_.request.is_everything())
            region = std::make_unique<Region>(
                options_.request, RegionScene{model_, geometry_, textured_, space, &readers});
        make_output_folder(folder_);
        write_views();
        if (!region) return record;
        std::vector<Tile> tiles;
        for (const Image& image :
             region_images(*region, geometry_, textured_, light_, cameras_, options_.size))
            tiles.push_back({image, cameras_[tiles.size()].name});
        ContactSheetOptions sheet;
        sheet.columns = 3;
        sheet.title = fmt::format("{:.1f} % of the surface", 100 * region->share());
        save_image(folder_ / "region.png", contact_sheet(tiles, sheet));
        record["share"] = region->share();
        record["materials"] = write_masks(*region, space);
        warn_of_other_masks(record["materials"]);
        return record;
    }

  private:
    /// Warns of masks from an earlier call, which stay because they may have been painted on.
    void warn_of_other_masks(const json& records) const {
        std::set<std::string> written, others;
        for (const json& record : records)
            if (record.contains("mask")) written.insert(record["mask"].get<std::string>());
        for (const auto& entry : fs::directory_iterator(folder_)) {
            const std::string name = entry.path().filename().string();
            if (name.starts_with("mask_") && name.ends_with(".png") && !written.contains(name))
                others.insert(name);
        }
        if (!others.empty())
            warn(fmt::format("{}: contains files of an earlier region: {}", folder_.string(),
                             fmt::join(others, ", ")));
    }

    void write_views() const {
        const at::Tensor linear = ModelDrawing(model_, light_).draw(cameras_, options_.size);
        for (std::size_t i = 0; i < cameras_.size(); ++i)
            save_image(folder_ / (cameras_[i].name + ".png"),
                       to_display(to_image(linear[static_cast<std::int64_t>(i)].cpu())));
        save_cameras(folder_ / "transforms.json", cameras_, model_);
    }

    json write_masks(const Region& region, const FieldSpace& space) const {
        const Atlas atlas = choose_uvs(model_, space, region.materials(), UvPolicy::keep);
        const auto masks = region_masks(region, model_, geometry_, atlas, options_.texture_size);
        json records = json::array();
        FileNames names;
        for (const int index : region.materials()) {
            const Material& material = model_.materials[static_cast<std::size_t>(index)];
            json record{{"name", material.name}};
            const auto mask = masks.find(index);
            if (mask != masks.end()) {
                const std::string plain = plain_file_name(material.name);
                const std::string file =
                    "mask_" +
                    names.unused(plain.empty() ? "material" + std::to_string(index) : plain) +
                    ".png";
                save_image(folder_ / file, mask->second);
                record["mask"] = file;
            }
            records.push_back(std::move(record));
        }
        return records;
    }

    const RegionCommand& options_;
    fs::path folder_;
    Model model_;
    Geometry geometry_;
    TexturedMaterials textured_;
    EnvironmentLight light_;
    std::vector<Camera> cameras_;
};

/// Throws UsageError if the selector `auto` lacks its sentences, or if sentences are given without
/// effect.
void check_sentences(const RegionCommand& options) {
    const bool both = !options.from.empty() && !options.to.empty();
    if (options.request.needs_sentences() && !both)
        throw UsageError("--region auto requires --from and --to");
    if (!options.request.needs_sentences() && !(options.from.empty() && options.to.empty()))
        throw UsageError("--from and --to require --region auto");
}

void run_region(const RegionCommand& options, at::Device device) {
    check_sentences(options);
    const at::NoGradGuard no_grad;
    const json record = RegionOutput(options, device).write();
    write_atomically(fs::path(options.output) / "region.json", std::string_view(record.dump(2)));
    if (options.json) {
        print_json(record);
        return;
    }
    if (record.contains("share"))
        fmt::print("{:.1f} % of the surface\n", 100 * record["share"].get<double>());
    else
        print_names(record);
    fmt::print("{}\n", options.output);
}

std::string selectors_help() {
    std::string text = "\nSelectors:\n";
    for (const SelectorKind& kind : selector_kinds())
        text += fmt::format("  {:<26}{}\n", kind.form, kind.help);
    return text;
}

}  // namespace

void add_region_command(CLI::App& app) {
    auto options = std::make_shared<RegionCommand>();
    CLI::App* command = add_command(app, "region", *options);
    command->add_option("MODEL", options->model, "A " + model_extensions_text() + " file")
        ->required();
    command
        ->add_option("-o,--output", options->output,
                     "Folder for region.png (the region), mask_MATERIAL.png (the region in UV "
                     "space), view_N.png and transforms.json (views to paint on)")
        ->type_name("FOLDER")
        ->required();
    command
        ->add_option(
            "--region", options->request.include,
            "Selector; several selectors are united. Default: list the names that can be selected")
        ->type_name("SELECTOR")
        ->allow_extra_args(false);
    command->add_option("--exclude", options->request.exclude, "Selector of a part to leave out")
        ->type_name("SELECTOR")
        ->allow_extra_args(false);
    command
        ->add_option("--feather", options->request.feather,
                     "Width of the soft border inside the region, in percent of the model's size")
        ->check(CLI::Range(0.0, 50.0));
    command
        ->add_option("--material", options->materials,
                     "Limit the region to these materials, by name")
        ->type_name("NAME,...");
    command
        ->add_option("--segmenter", options->segmenter,
                     "CLIPSeg in the transformers layout, for words=. Default: the prior's own, if "
                     "it has one")
        ->type_name("FOLDER");
    command
        ->add_option("--prior", options->prior,
                     "Diffusion model for auto, and for words= without a segmenter: a folder in "
                     "the diffusers layout, or a name. Default: the embedded prior")
        ->type_name("PRIOR");
    command->add_option("--from", options->from, "Sentence before the edit, for auto");
    command->add_option("--to", options->to, "Sentence after the edit, for auto");
    add_texture_folders(*command, options->texture_folders);
    command->add_option("--size", options->size, "Edge length of a view, in pixels")
        ->check(CLI::Range(32, 4096))
        ->capture_default_str();
    command
        ->add_option("--texture-size", options->texture_size,
                     "Edge length of the masks, in pixels; 0: the size of the textures")
        ->check(CLI::Range(0, 8192));
    command->footer(selectors_help());
    command->callback([options] { run_region(*options, start_command(*options)); });
}

}  // namespace item3d
