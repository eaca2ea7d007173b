#include "item3d/studio/server.h"

#include "item3d/serve/http_listener.h"
#include "item3d/studio/page_routes.h"
#include "item3d/studio/project_routes.h"
#include "item3d/studio/result_routes.h"
#include "item3d/studio/tool_routes.h"
#include "item3d/studio/upload_routes.h"

#include <optional>

namespace item3d {
namespace {

/// Number of threads. Event streams, uploads and silent connections hold one thread each, and
/// browsers keep six connections per page.
constexpr int server_threads = 256;
constexpr std::size_t longest_body = std::size_t{1536}
                                     << 20;  ///< in bytes; permits the largest upload

}  // namespace

void add_studio_routes(StudioRoutes& routes) {
    httplib::Server& server = routes.server;
    server.set_keep_alive_timeout(2);
    server.set_keep_alive_max_count(1000);
    server.set_read_timeout(20);
    server.set_write_timeout(20);
    server.set_payload_max_length(longest_body);
    server.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                                {"Referrer-Policy", "no-referrer"},
                                {"X-Frame-Options", "SAMEORIGIN"},
                                {"Cross-Origin-Resource-Policy", "same-origin"}});
    add_page_routes(routes);
    add_project_routes(routes);
    add_result_routes(routes);
    add_upload_routes(routes);
    add_tool_routes(routes);
    const auto unknown = [](const HttpRequest&, HttpResponse& response,
                            const httplib::ContentReader&) {
        refuse_and_close(response, http_status::not_found, "not found");
    };
    server.Post(".*", unknown);
    server.Put(".*", unknown);
    server.Patch(".*", unknown);
    server.Delete(".*", unknown);
    server.set_exception_handler([&studio = routes.studio](const HttpRequest&,
                                                           HttpResponse& response,
                                                           std::exception_ptr exception) {
        reply_exception(studio, response, exception);
    });
}

struct StudioServer::Sockets {
    httplib::Server server;
    Studio& studio;
    StudioRoutes routes{server, studio};
    std::optional<HttpListener> listener;

    explicit Sockets(Studio& of) : studio(of) {}
};

StudioServer::StudioServer(Studio& studio, const std::string& host, int port)
    : sockets_(std::make_unique<Sockets>(studio)) {
    add_studio_routes(sockets_->routes);
    sockets_->listener.emplace(sockets_->server, host, port, server_threads);
}

StudioServer::~StudioServer() {
    sockets_->studio.events().close();
}

int StudioServer::port() const {
    return sockets_->listener->port();
}

}  // namespace item3d
