#include "item3d/studio/tool_routes.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/io/save.h"
#include "item3d/io/variants.h"
#include "item3d/lighting/environment.h"
#include "item3d/studio/edit_history.h"
#include "item3d/studio/light_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr auto longest_tool = std::chrono::seconds(120);
constexpr const char* region_folder = "region";

/// Returns the file of a light that is not a preset.
fs::path light_file(Studio& studio, const std::string& name) {
    if (const auto id = result_of_light(name)) {
        const StudioResult result = studio.result(*id);
        return studio.folders().result(result.project, result.id) / "light.hdr";
    }
    return studio.folders().root() / "lights" / light_file_name(name);
}

/// Replies with a Radiance file. Presets without changes are cached, because every page starts with
/// a preset.
void answer_light(Studio& studio, const HttpRequest& request, HttpResponse& response) {
    constexpr int narrowest = 64, widest = 2048, usual = 512;
    const std::string name = request.matches[1].str();
    int width = usual;
    if (request.has_param("width"))
        width = std::clamp(std::atoi(request.get_param_value("width").c_str()), narrowest, widest);
    width &= ~1;
    const fs::path folder = studio.folders().root() / "lights";
    const bool is_changed = request.params.size() > (request.has_param("width") ? 1u : 0u);
    const fs::path kept = folder / "presets" / fmt::format("{}_{}.hdr", name, width);
    const bool is_kept = is_light_preset(name) && !is_changed;
    if (is_kept && fs::exists(kept)) {
        reply_file(request, response, kept);
        return;
    }
    const Image light = requested_light(
        name, width, [&](const std::string& key) { return request.get_param_value(key); },
        light_file(studio, name));
    const fs::path file = is_kept ? kept : studio.folders().incoming(".hdr");
    fs::create_directories(file.parent_path());
    save_image(file, light, 32);
    const Bytes bytes = read_bytes(file);
    if (!is_kept) fs::remove(file);
    response.set_header("Cache-Control", "no-cache");
    reply_bytes(response, std::string(bytes.begin(), bytes.end()), "image/vnd.radiance");
}

/// Returns the result that a request starts from, or nullopt if it starts from the project's model.
std::optional<StudioResult> parent_of_request(Studio& studio, const StudioProject& project,
                                              const Json& body) {
    const auto parent = body.find("parent");
    if (parent == body.end() || parent->is_null()) return std::nullopt;
    StudioResult result = studio.result(id_of(*parent));
    if (result.project != project.id) throw InputError("parent", "is not a result of this project");
    return result;
}

/// Returns the index of the first material of that name.
Json material_index(const StudioProject& project, const std::string& name) {
    for (const Json& material : project.model.value("materials", Json::array()))
        if (material.at("name") == name) return material.at("index");
    return nullptr;
}

/// Draws the region of the selectors. The files replace those of an earlier call.
Json draw_region(Studio& studio, const StudioProject& project, const Json& body, int revision) {
    const auto parent = parent_of_request(studio, project, body);
    const fs::path folder = studio.folders().project(project.id);
    StudioCommand command =
        studio.commands().region(project, body, parent ? &*parent : nullptr, region_folder);
    const Json request = {{"command", shown_command(command)}};
    command.arguments.insert(command.arguments.end(), {"--size", "256", "--texture-size", "512"});
    std::error_code ignored;
    fs::remove_all(folder / region_folder, ignored);
    studio.run_now(command, folder, folder / "region.log", longest_tool);
    const Json record = parse_json_or_throw(read_text(folder / region_folder / "region.json"));
    const auto url = [&](const std::string& name) {
        return fmt::format("api/projects/{}/region/{}?revision={}", project.id, name, revision);
    };
    Json reply = {{"share", record.value("share", 1.0)},
                  {"masks", Json::array()},
                  {"command", request["command"]}};
    if (fs::exists(folder / region_folder / "region.png")) reply["picture"] = url("region.png");
    for (const Json& material : record.value("materials", Json::array()))
        if (material.contains("mask"))
            reply["masks"].push_back({{"material", material_index(project, material.at("name"))},
                                      {"name", material.at("name")},
                                      {"url", url(material.at("mask").get<std::string>())}});
    return reply;
}

/// Returns a layer argument: "results/3:0.5:roughness,metallic".
std::string layer_argument(Studio& studio, const StudioProject& project, const Json& layer) {
    const StudioResult result = studio.result(id_of(layer.at("result")));
    if (result.project != project.id) throw InputError("layers", "belong to another project");
    std::string text =
        fmt::format("{}:{}", result_folder_name(result.id), layer.value("strength", 1.0));
    const auto channels = layer.value("channels", std::vector<std::string>());
    for (const std::string& channel : channels)
        if (channel.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") != std::string::npos)
            throw InputError("channels", "'" + channel + "' is not a channel");
    if (!channels.empty()) text += fmt::format(":{}", fmt::join(channels, ","));
    return text;
}

Json apply_layers(Studio& studio, const StudioProject& project, const Json& body, int revision) {
    StudioCommand command{"edit", {"layers", "source/" + project.file}};
    const Json layers = body.value("layers", Json::array());
    if (!layers.is_array() || layers.empty())
        throw InputError("layers", "expected at least one layer");
    for (const Json& layer : layers)
        command.arguments.push_back(layer_argument(studio, project, layer));
    command.arguments.insert(command.arguments.end(), {"-o", "mixed.glb"});
    const fs::path folder = studio.folders().project(project.id);
    studio.run_now(command, folder, folder / "layers.log", longest_tool);
    return {{"url", fmt::format("api/projects/{}/mixed.glb?revision={}", project.id, revision)},
            {"command", shown_command(command)}};
}

/// Makes one .glb with a variant for each of the results.
Json make_variants(Studio& studio, const StudioProject& project, const Json& body, int revision) {
    StudioCommand command{"edit", {"variants", "source/" + project.file}};
    std::vector<std::string> looks;
    bool has_names = false;
    for (const Json& id : body.value("results", Json::array())) {
        const StudioResult result = studio.result(id_of(id));
        if (result.project != project.id) throw InputError("results", "belong to another project");
        if (result.parent)
            throw InputError("results", "contain an edit of an edit",
                             "choose edits of the model itself");
        command.arguments.push_back(result_folder_name(result.id));
        looks.push_back(result.name.empty() ? text_of(result.request, "to") : result.name);
        has_names = has_names || !result.name.empty();
    }
    if (has_names)
        for (const std::string& name : variant_names_of(looks, {"original"}))
            command.arguments.push_back("--name=" + name);
    command.arguments.insert(command.arguments.end(), {"-o", "variants.glb"});
    const fs::path folder = studio.folders().project(project.id);
    studio.run_now(command, folder, folder / "variants.log", longest_tool);
    return {{"url", fmt::format("api/projects/{}/variants.glb?revision={}", project.id, revision)},
            {"command", shown_command(command)}};
}

void add_preview_routes(StudioRoutes& routes) {
    Studio& studio = routes.studio;
    const auto revision = std::make_shared<std::atomic<int>>(0);
    routes.post(
        R"(/api/projects/(\d+)/region)",
        [&studio, revision](const HttpRequest& request, HttpResponse& response, const Json& body) {
            reply_json(response, draw_region(studio, studio.project(number_of(request, 1)), body,
                                             ++*revision));
        });
    routes.get(R"(/api/projects/(\d+)/region/([A-Za-z0-9_-]+\.png))",
               [&studio](const HttpRequest& request, HttpResponse& response) {
                   const StudioProject project = studio.project(number_of(request, 1));
                   reply_file(request, response,
                              studio.folders().project(project.id) / region_folder /
                                  request.matches[2].str());
               });
    routes.post(
        R"(/api/projects/(\d+)/layers)",
        [&studio, revision](const HttpRequest& request, HttpResponse& response, const Json& body) {
            reply_json(response, apply_layers(studio, studio.project(number_of(request, 1)), body,
                                              ++*revision));
        });
    routes.post(
        R"(/api/projects/(\d+)/variants)",
        [&studio, revision](const HttpRequest& request, HttpResponse& response, const Json& body) {
            const StudioProject project = studio.project(number_of(request, 1));
            reply_json(response, make_variants(studio, project, body, ++*revision));
        });
    routes.get(R"(/api/projects/(\d+)/(mixed|variants)\.glb)", [&studio](const HttpRequest& request,
                                                                         HttpResponse& response) {
        const StudioProject project = studio.project(number_of(request, 1));
        reply_file(request, response,
                   studio.folders().project(project.id) / (request.matches[2].str() + ".glb"));
    });
}

}  // namespace

void add_tool_routes(StudioRoutes& routes) {
    Studio& studio = routes.studio;
    add_preview_routes(routes);
    routes.post(R"(/api/projects/(\d+)/estimate)",
                [&studio](const HttpRequest& request, HttpResponse& response, const Json& body) {
                    studio.project(number_of(request, 1));
                    const EditHistory history = read_edit_history(studio.store(), studio.folders());
                    reply_json(response, estimate_edit(body, history.defaults, history.costs,
                                                       history.threads));
                });
    routes.get(R"(/api/lights/([A-Za-z0-9_-]+)\.hdr)",
               [&studio](const HttpRequest& request, HttpResponse& response) {
                   answer_light(studio, request, response);
               });
}

}  // namespace item3d
