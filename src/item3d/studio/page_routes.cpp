#include "item3d/studio/page_routes.h"

#include "item3d/core/files.h"
#include "item3d/studio/about.h"
#include "item3d/studio/login_page.h"
#include "item3d/studio/static_files.h"

#include <atomic>
#include <memory>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
constexpr const char* html = "text/html; charset=utf-8";

void reply_page(HttpResponse& response, const std::string& body, int status = 200) {
    response.status = status;
    response.set_header("Cache-Control", "no-store");
    response.set_content(body, html);
}

/// Replies with the page to holders of the token. Replies to others with the password form or the
/// reason of the refusal.
void answer_index(Studio& studio, const HttpRequest& request, HttpResponse& response) {
    const RequestOrigin origin = origin_of(request);
    if (const std::string refusal = studio.access().refusal(origin); !refusal.empty()) {
        reply_page(response, refused_page(refusal), http_status::forbidden);
        return;
    }
    const bool shown = studio.access().admits(request.get_param_value("token"));
    if (!shown && !studio.access().knows_token(origin)) {
        if (studio.access().has_password())
            reply_page(response, login_page(""), http_status::forbidden);
        else
            reply_page(response,
                       refused_page("Open this page with the address that item3d studio printed, "
                                    "which contains its token."),
                       http_status::forbidden);
        return;
    }
    if (shown) response.set_header("Set-Cookie", studio.access().cookie());
    const std::string page = read_text(studio.options().page / "index.html");
    response.set_header("Content-Security-Policy", page_policy(page));
    reply_page(response, page);
}

void answer_login(Studio& studio, const HttpRequest& request, HttpResponse& response,
                  const httplib::ContentReader& reader) {
    constexpr std::size_t longest = 4096;
    std::string body;
    const bool whole = reader([&](const char* data, std::size_t size) {
        body.append(data, size);
        return body.size() <= longest;
    });
    if (const std::string refusal = studio.access().refusal(origin_of(request));
        !whole || !refusal.empty()) {
        refuse_and_close(response, http_status::forbidden,
                         whole ? refusal : "the request is too long");
        return;
    }
    if (!studio.access().admits_password(password_of_form(body))) {
        reply_page(response,
                   login_page("The password is wrong, or the last attempt was a moment ago."),
                   http_status::forbidden);
        return;
    }
    response.set_header("Set-Cookie", studio.access().cookie());
    response.status = http_status::see_other;
    response.set_header("Location", "./");
}

/// Streams events. A stream holds a thread, so their number is limited.
void answer_events(Studio& studio, const HttpRequest& request, HttpResponse& response,
                   std::shared_ptr<std::atomic<int>> open) {
    constexpr int max_streams = 24;
    constexpr auto heartbeat = std::chrono::milliseconds(10000);
    if (++*open > max_streams) {
        --*open;
        reply_error(response, http_status::unavailable,
                    "too many pages are open; close some of them");
        return;
    }
    const std::string last = request.get_header_value("Last-Event-ID");
    auto after = std::make_shared<std::int64_t>(
        last.empty() ? studio.events().last() : std::strtoll(last.c_str(), nullptr, 10));
    response.set_header("Cache-Control", "no-store");
    response.set_header("X-Accel-Buffering", "no");
    auto is_first = std::make_shared<bool>(true);
    response.set_chunked_content_provider(
        "text/event-stream",
        [&studio, after, is_first, heartbeat](std::size_t, httplib::DataSink& sink) {
            if (studio.events().is_closed()) return false;
            std::string text;
            if (std::exchange(*is_first, false))
                // An id alone is no event. It tells a page that is disconnected before its first
                // event where to continue.
                text = "retry: 1000\nid: " + std::to_string(*after) + "\n\n";
            else
                text = studio.events().wait(*after, heartbeat);
            return sink.write(text.data(), text.size());
        },
        [open](bool) { --*open; });
}

}  // namespace

void add_page_routes(StudioRoutes& routes) {
    Studio& studio = routes.studio;
    routes.server.Get("/", [&studio](const HttpRequest& request, HttpResponse& response) {
        try {
            answer_index(studio, request, response);
        } catch (...) {
            reply_exception(studio, response, std::current_exception());
        }
    });
    routes.server.Post("/login", [&studio](const HttpRequest& request, HttpResponse& response,
                                           const httplib::ContentReader& reader) {
        answer_login(studio, request, response, reader);
    });
    for (const auto& [name, folder] :
         {std::pair{"/app/(.+)", studio.options().page}, {"/three/(.+)", studio.options().three}})
        routes.server.Get(name, [files = std::make_shared<StaticFiles>(folder)](
                                    const HttpRequest& request, HttpResponse& response) {
            files->answer(request, response, request.matches[1].str());
        });
    routes.get("/api/about", [&studio](const HttpRequest&, HttpResponse& response) {
        reply_json(response, about_studio(studio));
    });
    routes.get("/api/events", [&studio, open = std::make_shared<std::atomic<int>>(0)](
                                  const HttpRequest& request, HttpResponse& response) {
        answer_events(studio, request, response, open);
    });
}

}  // namespace item3d
