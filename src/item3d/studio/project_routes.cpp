#include "item3d/studio/project_routes.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"

#include <algorithm>

namespace item3d {
namespace {

using Json = nlohmann::json;

std::int64_t parameter(const HttpRequest& request, const char* name, std::int64_t otherwise) {
    if (!request.has_param(name)) return otherwise;
    return std::strtoll(request.get_param_value(name).c_str(), nullptr, 10);
}

Json whole_project(Studio& studio, const StudioProject& project) {
    Json json = project_json(project);
    json["model"] = project.model;
    json["model"]["url"] = project.file.empty()
                               ? Json()
                               : Json("api/projects/" + std::to_string(project.id) + "/model.glb");
    json["results"] = Json::array();
    for (const StudioResult& result : studio.store().results(project.id))
        json["results"].push_back(result_json(studio.jobs().with_status(result)));
    return json;
}

std::optional<std::int64_t> parent_of(const Json& body) {
    const auto parent = body.find("parent");
    if (parent == body.end() || parent->is_null()) return std::nullopt;
    return id_of(*parent);
}

StudioResult result_of(Studio& studio, const HttpRequest& request, const std::string& kind,
                       const Json& body) {
    StudioResult result;
    result.project = studio.project(number_of(request, 1)).id;
    result.kind = kind;
    result.parent = parent_of(body);
    result.request = body;
    result.name = shown_name(text_of(body, "name"), "");
    return result;
}

}  // namespace

void add_project_routes(StudioRoutes& routes) {
    Studio& studio = routes.studio;
    routes.get("/api/projects", [&studio](const HttpRequest& request, HttpResponse& response) {
        constexpr std::int64_t maximum = 1000;
        const std::int64_t limit = parameter(request, "limit", maximum);
        Json list = Json::array();
        for (const StudioProject& project : studio.store().projects(
                 std::clamp<std::int64_t>(limit, 1, maximum), parameter(request, "before", 0)))
            list.push_back(project_json(project));
        reply_json(response, list);
    });
    routes.get(
        R"(/api/projects/(\d+))", [&studio](const HttpRequest& request, HttpResponse& response) {
            reply_json(response, whole_project(studio, studio.project(number_of(request, 1))));
        });
    routes.patch(R"(/api/projects/(\d+))",
                 [&studio](const HttpRequest& request, HttpResponse& response, const Json& body) {
                     const StudioProject project = studio.project(number_of(request, 1));
                     if (body.contains("favourite"))
                         studio.store().mark_project(project.id, body["favourite"].get<bool>());
                     if (body.contains("name"))
                         studio.store().rename_project(
                             project.id, shown_name(text_of(body, "name"), project.name));
                     reply_json(response, project_json(studio.project(project.id)));
                 });
    routes.remove(R"(/api/projects/(\d+))",
                  [&studio](const HttpRequest& request, HttpResponse& response) {
                      studio.remove_project(number_of(request, 1));
                      reply_json(response, Json::object());
                  });
    routes.get(R"(/api/projects/(\d+)/model\.glb)", [&studio](const HttpRequest& request,
                                                              HttpResponse& response) {
        const StudioProject project = studio.project(number_of(request, 1));
        reply_file(request, response, studio.folders().project(project.id) / "model.glb");
    });
    routes.post(R"(/api/projects/(\d+)/edits)",
                [&studio](const HttpRequest& request, HttpResponse& response, const Json& body) {
                    reply_json(
                        response,
                        result_json(studio.jobs().add(result_of(studio, request, "edit", body))));
                });
    routes.post(
        R"(/api/projects/(\d+)/relight)",
        [&studio](const HttpRequest& request, HttpResponse& response, const Json& body) {
            reply_json(response,
                       result_json(studio.jobs().add(result_of(studio, request, "relight", body))));
        });
}

}  // namespace item3d
