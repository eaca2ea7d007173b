// Command item3d bench: measures the speed of this machine for item3d's tasks.
#include "apps/item3d/bench/bench_guidance.h"
#include "apps/item3d/bench/bench_render.h"
#include "apps/item3d/bench/commands.h"
#include "apps/item3d/command.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/lighting/environment.h"

#include <omp.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {
namespace {

struct BenchRenderCommand : CommonOptions {
    std::vector<std::string> models;
    std::vector<std::string> sizes{"64x64", "256x256", "512x512"};
    std::string light = "studio";
    int repeats = 9;
};

constexpr int prefilter_size = 64;

/// Numbers of squares along a sphere's equator, for 5,832, 100,352 and a million triangles.
constexpr int sphere_squares[] = {54, 224, 708};

std::vector<BenchScene> load_scenes(const BenchRenderCommand& options) {
    std::vector<BenchScene> scenes;
    for (const std::string& path : options.models) {
        BenchScene& scene = scenes.emplace_back();
        scene.name = std::filesystem::path(path).filename().string();
        scene.model = load_model(path);
    }
    if (!scenes.empty()) return scenes;
    BenchScene& mug = scenes.emplace_back();
    mug.name = "mug.glb";
    mug.model = load_model(assets_folder() / "demo" / "mug.glb");
    for (const int squares : sphere_squares)
        scenes.push_back(sphere_scene(squares));
    return scenes;
}

/// Returns the requested device, or all available devices for `auto`.
std::vector<at::Device> choose_devices(const BenchRenderCommand& options, at::Device preferred) {
    std::vector<at::Device> devices{preferred};
    if (options.device == "auto" && preferred.is_cuda()) {
        devices.insert(devices.begin(), at::Device(at::kCPU));
    }
    return devices;
}

std::string device_name(at::Device device) {
    return device.is_cuda() ? "cuda" : "cpu";
}

nlohmann::json stage_json(const StageTime& time) {
    return {
        {"stage", time.stage}, {"forward_ms", time.forward_ms}, {"backward_ms", time.backward_ms}};
}

nlohmann::json row_json(const BenchScene& scene, ImageSize size, at::Device device,
                        const RenderTimes& times) {
    nlohmann::json row = {{"model", scene.name},
                          {"triangles", scene.model.triangle_count()},
                          {"width", size.width},
                          {"height", size.height},
                          {"covered_pixels", times.covered_pixels},
                          {"device", device_name(device)},
                          {"forward_ms", times.forward_ms},
                          {"forward_backward_ms", times.forward_backward_ms},
                          {"neural_forward_ms", times.neural_forward_ms},
                          {"neural_forward_backward_ms", times.neural_forward_backward_ms},
                          {"stages", nlohmann::json::array()}};
    for (const StageTime& stage : times.stages)
        row["stages"].push_back(stage_json(stage));
    // The camera is written too, so that another renderer can use the same view.
    const Camera camera = scene.camera(size);
    nlohmann::json matrix = nlohmann::json::array();
    for (int i = 0; i < 4; ++i) {
        nlohmann::json line = nlohmann::json::array();
        for (int j = 0; j < 4; ++j)
            line.push_back(camera.camera_to_world[j][i]);
        matrix.push_back(line);
    }
    row["camera"] = {{"camera_to_world", matrix},
                     {"field_of_view_x_degrees", camera.field_of_view_x * 180 / pi}};
    return row;
}

void print_row(const BenchScene& scene, ImageSize size, at::Device device,
               const RenderTimes& times) {
    fmt::print("{}, {} triangles, {} x {}, {} pixels covered, {}\n", scene.name,
               scene.model.triangle_count(), size.width, size.height, times.covered_pixels,
               device_name(device));
    const auto line = [](const std::string& name, double forward, double backward) {
        fmt::print("  {:28} {:>10.2f} {:>10.2f}\n", name, forward, backward);
    };
    fmt::print("  {:28} {:>10} {:>10}\n", "ms", "forward", "backward");
    for (const StageTime& stage : times.stages)
        line(stage.stage, stage.forward_ms, stage.backward_ms);
    fmt::print("  {:28} {:>10} {:>10}\n", "", "forward", "and back");
    line("image from a texture", times.forward_ms, times.forward_backward_ms);
    line("image from the field", times.neural_forward_ms, times.neural_forward_backward_ms);
    fmt::print("\n");
}

void run_bench_render(const BenchRenderCommand& options, at::Device preferred) {
    std::vector<ImageSize> sizes;
    for (const std::string& size : options.sizes)
        sizes.push_back(parse_size(size));
    const std::vector<BenchScene> scenes = load_scenes(options);
    const std::vector<at::Device> devices = choose_devices(options, preferred);
    const Image light = load_light(options.light);

    nlohmann::json rows = nlohmann::json::array();
    const std::size_t total = devices.size() * scenes.size() * sizes.size() + 1;
    Progress progress("bench", static_cast<std::int64_t>(total));
    std::int64_t done = 0;
    for (const at::Device device : devices) {
        for (const BenchScene& scene : scenes) {
            for (const ImageSize size : sizes) {
                const RenderTimes times = time_render(scene, light, size, device, options.repeats);
                rows.push_back(row_json(scene, size, device, times));
                if (!options.json) print_row(scene, size, device, times);
                progress.update(++done);
            }
        }
    }
    const StageTime time = time_prefilter(prefilter_size, options.repeats);
    nlohmann::json prefiltering = stage_json(time);
    prefiltering["device"] = device_name(at::kCPU);
    prefiltering["face_size"] = prefilter_size;
    if (!options.json) {
        fmt::print("{} to cubes of {} texels, cpu: {:.1f} ms forward, {:.1f} ms backward\n\n",
                   time.stage, prefilter_size, time.forward_ms, time.backward_ms);
    }
    progress.update(++done);
    progress.finish();
    if (!options.json) return;
    // The top-level numbers are those of the last row, which has the requested size and the fastest
    // device.
    nlohmann::json result = rows.back();
    result["threads"] = omp_get_max_threads();
    result["repeats"] = options.repeats;
    result["light"] = options.light;
    result["prefilter"] = nlohmann::json::array({prefiltering});
    result["rows"] = rows;
    print_json(result);
}

void add_bench_render(CLI::App& app) {
    auto options = std::make_shared<BenchRenderCommand>();
    CLI::App* command =
        add_command(app, "render", "Milliseconds of each stage of the renderer", *options);
    command
        ->add_option(
            "--model", options->models,
            "Models to render. Default: the demo's mug, and spheres of up to a million triangles")
        ->type_name("FILE");
    command
        ->add_option("--size", options->sizes, "Size in pixels. Default: 64, 256 and 512 squared")
        ->type_name("WxH");
    command
        ->add_option("--light", options->light,
                     "Light: " + light_presets_text() + ", or an equirectangular .hdr or .exr file")
        ->type_name("LIGHT")
        ->capture_default_str();
    command
        ->add_option("--repeats", options->repeats, "Runs of each measurement; the median is shown")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    command->callback([options] { run_bench_render(*options, start_command(*options)); });
}

}  // namespace

void add_bench_command(CLI::App& app) {
    CLI::App* command = add_command_group(app, "bench");
    command->require_subcommand(1);
    add_bench_render(*command);
    add_bench_guidance(*command);
}

}  // namespace item3d
