// Measurement of the light that an edit paints into the base colour.
//
//   light_leak -o DIR --mesh cow=spot.obj [--word red] [--augment off] [--light noon]
//
// The program edits a white model to each word, once for each value of --augment. For each edit it
// prints one line of JSON, with the columns of docs/relight.md:
//   correlation        correlation of two logarithms over points of the surface: that of the base
//                      colour's luminance, and that of the luminance of the edit's diffuse light
//   slope              slope of the regression of the base colour's logarithm on the light's
//                      logarithm; 1 means that all of the shading is painted into the base colour
//   relit_difference   root mean square difference between renders of the result and of the same
//                      model with its mean base colour everywhere, for each of three other lights
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/edit.h"
#include "item3d/field/surface_points.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/io/save.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/textured_materials.h"
#include "item3d/report/display_image.h"
#include "item3d/report/model_images.h"
#include "item3d/suite/models.h"
#include "item3d/tensors/process.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {
namespace {

using nlohmann::json;

struct LeakOptions {
    std::filesystem::path output, prior, mesh;
    std::string noun;
    std::vector<std::string> words{"red", "blue", "wooden", "golden"};
    std::vector<std::string> augment{"off", "rotate", "all"};
    std::string light = "noon";
    json overrides = json::object();
};

constexpr int surface_points = 20000;
constexpr int light_height = 24;  ///< rows of the light's image, which are enough for irradiance
const std::vector<std::string> other_lights{"studio", "overcast", "sunset"};

struct Leak {
    double correlation = 0;
    double slope = 0;
    Vec3 mean_color{0};
};

Leak measure_leak(const Model& model, const std::string& light_name) {
    const at::NoGradGuard no_grad;
    const Image light = resize(load_light(light_name), 2 * light_height, light_height);
    std::vector<int> materials;
    for (std::size_t i = 0; i < model.materials.size(); ++i)
        materials.push_back(static_cast<int>(i));
    const Geometry geometry = Geometry::from_model(model);
    const FieldSpace space(model, materials);
    Random random(0);
    const Surface surface = SurfaceSampler(geometry, space).sample(surface_points, random);
    const at::Tensor color = TexturedMaterials(model).sample(surface).base_color;
    const at::Tensor weights = at::tensor({0.2126f, 0.7152f, 0.0722f});
    const at::Tensor painted = (color * weights).sum(1).clamp_min(1e-4).log();
    const at::Tensor normals = surface.normal.contiguous();
    at::Tensor received = at::empty({normals.size(0)});
    const float* n = normals.const_data_ptr<float>();
    float* out = received.data_ptr<float>();
    for (std::int64_t i = 0; i < normals.size(0); ++i) {
        const Vec3 rgb = irradiance_over_pi(light, Vec3(n[3 * i], n[3 * i + 1], n[3 * i + 2]));
        out[i] = std::log(0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z);
    }
    const at::Tensor x = received - received.mean(), y = painted - painted.mean();
    const double xy = (x * y).mean().item<double>(), xx = x.square().mean().item<double>(),
                 yy = y.square().mean().item<double>();
    const at::Tensor mean = color.mean(0);
    return {xy / std::sqrt(std::max(xx * yy, 1e-20)), xy / xx,
            Vec3(mean[0].item<float>(), mean[1].item<float>(), mean[2].item<float>())};
}

/// Returns the root mean square difference, in sRGB and over the model's pixels, between renders of
/// `edited` and of the same model with `mean_color` everywhere.
double relit_difference(const Model& edited, const Vec3& mean_color, const std::string& light) {
    Model even = edited;
    for (Material& material : even.materials) {
        material.base_color_texture = -1;
        material.base_color_factor = Vec4(mean_color, 1);
    }
    const EnvironmentLight prefiltered = prefilter(make_light_preset(light), 64);
    const auto cameras = image_cameras(edited, 4);
    const at::Tensor a = draw_images(edited, prefiltered, cameras, 192);
    const at::Tensor b = draw_images(even, prefiltered, cameras, 192);
    const at::Tensor square = (over_white(a) - over_white(b)).square().sum();
    return std::sqrt((square / (3 * a.select(3, 3).sum())).item<double>());
}

json run_case(const LeakOptions& options, const std::string& word, const std::string& augment) {
    EditRequest request;
    request.output = options.output / (word + "-" + augment);
    make_output_folder(request.output);
    request.model = request.output / "source.glb";
    save_model(request.model, plain_model(load_model(options.mesh), Vec3(0.85f)));
    request.prior = options.prior;
    json overrides = {{"from", "a white " + options.noun},
                      {"to", "a " + word + " " + options.noun},
                      {"light", options.light},
                      {"light_augment", augment},
                      {"detail", "off"}};
    overrides.update(options.overrides);
    request.plan = resolve_plan(options.prior, overrides);
    edit_model(request);
    const Model edited = load_model(request.output / "model.glb");
    const Leak leak = measure_leak(edited, options.light);
    json relit = json::object();
    for (const std::string& light : other_lights)
        relit[light] = relit_difference(edited, leak.mean_color, light);
    return {{"word", word},
            {"augment", augment},
            {"correlation", leak.correlation},
            {"slope", leak.slope},
            {"mean_color", {leak.mean_color.x, leak.mean_color.y, leak.mean_color.z}},
            {"relit_difference", relit}};
}

}  // namespace
}  // namespace item3d

int main(int argc, char** argv) {
    item3d::prepare_process();
    item3d::LeakOptions options;
    std::string mesh;
    std::string settings = "{}";
    CLI::App app("Measures how much light an edit paints into the base colour.");
    app.add_option("-o,--output", options.output, "Folder for all results")->required();
    app.add_option("--prior", options.prior, "Prior. Default: the embedded prior");
    app.add_option("--mesh", mesh, "Model and its noun, NOUN=FILE")->required();
    app.add_option("--word", options.words, "Words for the new look, one edit each");
    app.add_option("--augment", options.augment,
                   "Values of the edit's --light-augment: off, rotate, all");
    app.add_option("--light", options.light, "Light of the edit, a preset or a file");
    app.add_option("--settings", settings, "Settings of the edit as JSON, {\"seed\": 1}");
    CLI11_PARSE(app, argc, argv);
    try {
        options.prior = item3d::find_prior(options.prior.string());
        const auto split = mesh.find('=');
        if (split == std::string::npos) throw item3d::UsageError("--mesh takes NOUN=FILE");
        options.noun = mesh.substr(0, split);
        options.mesh = mesh.substr(split + 1);
        options.overrides = nlohmann::json::parse(settings);
        for (const std::string& word : options.words) {
            for (const std::string& augment : options.augment) {
                fmt::print("{}\n", item3d::run_case(options, word, augment).dump());
                std::fflush(stdout);
            }
        }
    } catch (const item3d::Error& error) {
        fmt::print(stderr, "light_leak: error: {}\n", error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}
