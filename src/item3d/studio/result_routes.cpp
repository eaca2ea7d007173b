#include "item3d/studio/result_routes.h"

#include "item3d/core/files.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
/// Content policy of reports: no scripts, and no resources from outside.
constexpr const char* report_policy =
    "default-src 'none'; img-src 'self' data:; style-src 'unsafe-inline'; sandbox allow-popups; "
    "frame-ancestors 'self'";

/// True for text files, which may contain this machine's folders.
bool is_text(const std::string& name) {
    return name.ends_with(".json") || name.ends_with(".html") || name.ends_with(".txt");
}

void answer_file(Studio& studio, const HttpRequest& request, HttpResponse& response) {
    const StudioResult result = studio.result(number_of(request, 1));
    const std::string name = request.matches[2].str();
    const std::vector<std::string> files = studio.files_of(result);
    if (std::find(files.begin(), files.end(), name) == files.end()) {
        reply_error(response, http_status::not_found, "the result has no such file");
        return;
    }
    const fs::path file = studio.folders().result(result.project, result.id) / name;
    if (!is_text(name)) {
        reply_file(request, response, file);
        return;
    }
    response.set_header("Cache-Control", "no-cache");
    reply_bytes(response, studio.folders().without_paths(read_text(file)), content_type(file));
    if (name.ends_with(".html")) response.set_header("Content-Security-Policy", report_policy);
}

StudioResult changed(StudioResult result, const Json& body) {
    constexpr std::size_t longest_note = 10000;
    if (body.contains("favourite")) result.favourite = body["favourite"].get<bool>();
    if (body.contains("note"))
        result.note = body["note"].get<std::string>().substr(0, longest_note);
    if (body.contains("name")) result.name = shown_name(text_of(body, "name"), "");
    return result;
}

}  // namespace

void add_result_routes(StudioRoutes& routes) {
    Studio& studio = routes.studio;
    const auto reply_result = [&studio](HttpResponse& response, std::int64_t id) {
        reply_json(response, result_json(studio.jobs().with_status(studio.result(id))));
    };
    routes.get(R"(/api/results/(\d+))",
               [reply_result](const HttpRequest& request, HttpResponse& response) {
                   reply_result(response, number_of(request, 1));
               });
    for (const auto& [name, change] : {std::pair{"cancel", &StudioJobs::cancel},
                                       {"pause", &StudioJobs::pause},
                                       {"resume", &StudioJobs::resume}})
        routes.post(std::string(R"(/api/results/(\d+)/)") + name,
                    [&studio, reply_result, change = change](const HttpRequest& request,
                                                             HttpResponse& response, const Json&) {
                        const std::int64_t id = studio.result(number_of(request, 1)).id;
                        (studio.jobs().*change)(id);
                        reply_result(response, id);
                    });
    routes.patch(
        R"(/api/results/(\d+))", [&studio, reply_result](const HttpRequest& request,
                                                         HttpResponse& response, const Json& body) {
            const StudioResult result = changed(studio.result(number_of(request, 1)), body);
            studio.store().annotate_result(result);
            studio.jobs().tell(result.id);
            reply_result(response, result.id);
        });
    routes.remove(R"(/api/results/(\d+))",
                  [&studio](const HttpRequest& request, HttpResponse& response) {
                      studio.jobs().remove(studio.result(number_of(request, 1)).id);
                      reply_json(response, Json::object());
                  });
    routes.get(R"(/api/results/(\d+)/files/(.+))",
               [&studio](const HttpRequest& request, HttpResponse& response) {
                   answer_file(studio, request, response);
               });
}

}  // namespace item3d
