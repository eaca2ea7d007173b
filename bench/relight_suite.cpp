// Measurement of how well relighting follows words (docs/relight.md).
//
//   relight_suite -o DIR --mesh cow=spot.obj --mesh teapot=teapot.obj --mesh object=bunny.obj
//
// Each mesh is relit with the words "in the dark", "at sunset", "in bright light" and "at night".
// The result must be darker, warmer, brighter, or darker and colder, respectively. Luminance is
// measured in the images, colour temperature in the light. Each result is saved as a model with its
// light, in which the source's materials, meshes and images must have the same bytes as before.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/relight.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/gltf/document.h"
#include "item3d/io/gltf/light.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/io/save.h"
#include "item3d/lighting/description.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/prefilter/image_based_light.h"
#include "item3d/report/contact_sheet.h"
#include "item3d/report/display_image.h"
#include "item3d/report/model_images.h"
#include "item3d/tensors/process.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace item3d {
namespace {

using nlohmann::json;

struct RelightSuiteOptions {
    std::filesystem::path output;
    std::filesystem::path prior;
    std::vector<std::pair<std::string, std::filesystem::path>> meshes;  ///< noun, file of each
    json overrides = json::object();
};

struct Wish {
    std::string words;
    int luminance;    ///< required sign of the change; 0 allows any change
    int temperature;  ///< required sign of the change; 0 allows any change
};
const std::array<Wish, 4> wishes{
    {{"in the dark", -1, 0}, {"at sunset", 0, -1}, {"in bright light", 1, 0}, {"at night", -1, 1}}};

bool moved(double before, double after, int wanted) {
    return wanted == 0 || (wanted > 0 ? after > before : after < before);
}

constexpr int image_pixels = 256;

struct LitImage {
    Image image;
    double luminance = 0;  ///< mean linear luminance of the model in three views
};

LitImage look(const Model& model, const Image& light) {
    const at::Tensor linear =
        draw_images(model, prefilter(light, 128), image_cameras(model, 3), image_pixels);
    const at::Tensor weights = at::tensor({0.2126f, 0.7152f, 0.0722f});
    const at::Tensor sum = (linear.narrow(3, 0, 3).clamp(0, 1) * weights).sum();
    return {to_display(to_image(linear[0]), Vec3(0.6f)),
            (sum / linear.select(3, 3).sum()).item<double>()};
}

/// Returns true if `lit` has the same materials and meshes as `source`, and the same bytes of
/// images and vertices. In `lit` the light's images follow those of `source`.
bool is_untouched(const std::filesystem::path& source, const std::filesystem::path& lit) {
    const auto before = parse_gltf(source, read_bytes(source));
    const auto after = parse_gltf(lit, read_bytes(lit));
    for (const char* list : {"materials", "textures", "samplers", "meshes", "accessors"})
        if (before->json.value(list, Json()) != after->json.value(list, Json())) return false;
    const std::size_t images = before->json.value("images", Json::array()).size();
    if (after->json.value("images", Json::array()).size() < images) return false;
    for (std::size_t i = 0; i < images; ++i)
        if (read_image_bytes(*before, i) != read_image_bytes(*after, i)) return false;
    const Bytes& vertices = before->buffers[0];
    return after->buffers[0].size() >= vertices.size() &&
           std::equal(vertices.begin(), vertices.end(), after->buffers[0].begin());
}

bool is_untouched_in(const Image& light, const std::filesystem::path& source,
                     const std::filesystem::path& lit) {
    const LightLobe lobe = brightest_lobe(light);
    ModelLights lights;
    lights.sun = DirectionalLight{lobe.direction, Vec3(lobe.irradiance)};
    lights.surroundings = make_image_based_light(light);
    save_lit_model(lit, load_model(source), lights);
    return is_untouched(source, lit);
}

json run_case(const std::string& noun, const std::filesystem::path& mesh, const Wish& wish,
              const RelightSuiteOptions& options, std::vector<Tile>& tiles) {
    const std::string article = std::string("aeiou").find(noun.front()) != noun.npos ? "an " : "a ";
    EditRequest request;
    request.model = mesh;
    request.prior = options.prior;
    request.output = options.output / "work";
    make_output_folder(request.output);
    json overrides = options.overrides;
    overrides.update({{"from", article + noun}, {"to", article + noun + " " + wish.words}});
    overrides["optimize"] = "light";
    request.plan = resolve_plan(options.prior, overrides);
    EditSession session;
    const FoundLight found = find_light(request, session);

    const Image first = load_light(request.plan.light);
    const Model model = load_model(mesh);
    const LitImage before = look(model, first);
    const LitImage after = look(model, found.light);
    save_image(options.output / fmt::format("{}-{}.exr", noun, tiles.size()), found.light, 32);
    const double kelvin_before = describe_light(first).color_temperature.value_or(0);
    // A light that is bluer than every black body has no colour temperature. Here it counts as the
    // coldest light.
    const double kelvin_after = describe_light(found.light).color_temperature.value_or(1e5);
    const bool right = moved(before.luminance, after.luminance, wish.luminance) &&
                       moved(kelvin_before, kelvin_after, wish.temperature);
    if (&wish == &wishes.front()) tiles.push_back({before.image, noun});
    tiles.push_back({after.image, wish.words});
    return {{"mesh", noun},
            {"to", request.plan.to},
            {"luminance", {before.luminance, after.luminance}},
            {"color_temperature", {kelvin_before, kelvin_after}},
            {"right", right},
            {"untouched", is_untouched_in(found.light, mesh, options.output / "lit.glb")},
            {"values", found.record.value("values", json())},
            {"seconds", found.record["seconds"]}};
}

void run_suite(const RelightSuiteOptions& options) {
    std::vector<json> results;
    std::vector<Tile> tiles;
    int right = 0, untouched = 0;
    make_output_folder(options.output);
    for (const auto& [noun, mesh] : options.meshes) {
        const std::filesystem::path source = options.output / (noun + ".glb");
        save_model(source, load_model(mesh));
        for (const Wish& wish : wishes) {
            results.push_back(run_case(noun, source, wish, options, tiles));
            const json& result = results.back();
            right += result["right"].get<bool>() ? 1 : 0;
            untouched += result["untouched"].get<bool>() ? 1 : 0;
            note(fmt::format("{}: {} {} {}", result["to"].dump(), result["luminance"].dump(),
                             result["color_temperature"].dump(), result["right"].dump()));
        }
    }
    ContactSheetOptions sheet;
    sheet.columns = static_cast<int>(wishes.size()) + 1;
    save_image(options.output / "sheet.png", contact_sheet(tiles, sheet));
    const json summary = {{"right", right},
                          {"untouched", untouched},
                          {"cases", results.size()},
                          {"results", results}};
    write_atomically(options.output / "relight.json", summary.dump(2) + "\n");
    fmt::print("{} of {} right, {} untouched\n", right, results.size(), untouched);
}

}  // namespace
}  // namespace item3d

int main(int argc, char** argv) {
    item3d::prepare_process();
    item3d::RelightSuiteOptions options;
    std::vector<std::string> meshes;
    std::string settings = "{}";
    CLI::App app(
        "Relights models by words and reports whether luminance and colour temperature changed as "
        "the words say.");
    app.add_option("-o,--output", options.output, "Folder for all results")->required();
    app.add_option("--prior", options.prior, "Prior. Default: the embedded prior");
    app.add_option("--mesh", meshes, "Models and their nouns, NOUN=FILE")->required();
    app.add_option("--settings", settings, "Settings of the edit as JSON, {\"seed\": 1}");
    CLI11_PARSE(app, argc, argv);
    try {
        options.prior = item3d::find_prior(options.prior.string());
        options.overrides = nlohmann::json::parse(settings);
        for (const std::string& mesh : meshes) {
            const auto split = mesh.find('=');
            if (split == std::string::npos) throw item3d::UsageError("--mesh takes NOUN=FILE");
            options.meshes.emplace_back(mesh.substr(0, split), mesh.substr(split + 1));
        }
        item3d::run_suite(options);
    } catch (const item3d::Error& error) {
        fmt::print(stderr, "relight_suite: error: {}\n", error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}
