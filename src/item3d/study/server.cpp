#include "item3d/study/server.h"

#include "item3d/core/progress.h"
#include "item3d/serve/http_listener.h"
#include "item3d/study/html_pages.h"

#include <httplib.h>

#include <optional>

namespace item3d {
namespace {

// A participant's browser opens up to six connections. Each occupies a thread for at most a second.
constexpr int server_threads = 32;
constexpr std::size_t longest_request = 16384;

SiteRequest site_request(const httplib::Request& from) {
    SiteRequest request;
    request.is_post = from.method == "POST";
    request.path = from.path;
    for (const auto& [key, value] : from.params)
        request.form.emplace(key, value);
    return request;
}

void fill_reply(const SiteReply& from, httplib::Response& response) {
    response.status = from.status;
    response.set_header("Cache-Control", from.may_be_kept ? "private, max-age=86400" : "no-store");
    if (from.location.empty())
        response.set_content(from.body, from.type);
    else
        response.set_header("Location", from.location);
}

}  // namespace

void add_study_routes(httplib::Server& server, StudySite& site) {
    server.set_keep_alive_timeout(1);
    server.set_read_timeout(5);
    server.set_write_timeout(20);
    server.set_payload_max_length(longest_request);
    server.set_default_headers({{"Content-Security-Policy",
                                 "default-src 'none'; img-src 'self' data:; style-src 'self'; "
                                 "form-action 'self'; base-uri 'none'; frame-ancestors 'none'"},
                                {"X-Content-Type-Options", "nosniff"},
                                {"Referrer-Policy", "no-referrer"}});
    const auto answer = [&site](const httplib::Request& request, httplib::Response& response) {
        fill_reply(site.reply(site_request(request)), response);
    };
    server.Get(".*", answer);
    server.Post(".*", answer);
    server.set_exception_handler([](const httplib::Request&, httplib::Response& response,
                                    std::exception_ptr exception) {
        std::string problem = "unknown";
        try {
            std::rethrow_exception(exception);
        } catch (const std::exception& error) {
            problem = message_of(error);
        }
        warn(problem);
        fill_reply({500, "text/html; charset=utf-8",
                    message_page("Not stored",
                                 "Your answer could not be stored. Please tell the people who sent "
                                 "you the link, and open it again later."),
                    "", false},
                   response);
    });
}

struct StudyServer::Sockets {
    httplib::Server server;
    std::optional<HttpListener> listener;
};

StudyServer::StudyServer(StudySite& site, const std::string& host, int port)
    : sockets_(std::make_unique<Sockets>()) {
    add_study_routes(sockets_->server, site);
    sockets_->listener.emplace(sockets_->server, host, port, server_threads);
}

StudyServer::~StudyServer() = default;

int StudyServer::port() const {
    return sockets_->listener->port();
}

}  // namespace item3d
