#include "item3d/study/server.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/study/html_pages.h"

#include <fmt/format.h>
#include <httplib.h>
#include <netinet/tcp.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <thread>

namespace item3d {
namespace {

// A participant's browser holds up to six connections; each waits in a thread for a second at most.
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

/// Two programs that both ask for SO_REUSEPORT, which httplib does by itself, would share the port.
void set_study_options(socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
}

}  // namespace

struct StudyServer::Sockets {
    httplib::Server server;
    int port = 0;
    std::thread thread;
};

StudyServer::StudyServer(StudySite& site, const std::string& host, int port)
    : sockets_(std::make_unique<Sockets>()) {
    httplib::Server& server = sockets_->server;
    server.new_task_queue = [] { return new httplib::ThreadPool(server_threads); };
    server.set_socket_options(set_study_options);
    server.set_tcp_nodelay(true);
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
            problem = error.what();
        }
        warn(problem);
        fill_reply({500, "text/html; charset=utf-8",
                    message_page("Not stored",
                                 "Your answer could not be stored. Please tell the people who sent "
                                 "you the link, and open it again later."),
                    "", false},
                   response);
    });
    errno = 0;
    if (port == 0)
        sockets_->port = server.bind_to_any_port(host);
    else
        sockets_->port = server.bind_to_port(host, port) ? port : -1;
    if (sockets_->port < 0) {
        if (errno == EADDRINUSE)
            throw ResourceError(fmt::format(
                "port {} of {} is taken by another program; name another with --port", port, host));
        throw InputError("--host " + host,
                         fmt::format("port {} cannot be opened there ({})", port,
                                     errno != 0 ? std::strerror(errno) : "no such host"),
                         "name an address of this machine");
    }
    sockets_->thread = std::thread([&server] { server.listen_after_bind(); });
    while (!server.is_running())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

StudyServer::~StudyServer() {
    sockets_->server.stop();
    sockets_->thread.join();
}

int StudyServer::port() const {
    return sockets_->port;
}

bool is_loopback(const std::string& host) {
    return host == "localhost" || host == "::1" || host.starts_with("127.");
}

std::string server_address(const std::string& host, int port) {
    std::string name = host;
    if (host == "0.0.0.0" || host == "::") {
        std::array<char, 256> machine{};
        if (::gethostname(machine.data(), machine.size() - 1) == 0) name = machine.data();
    }
    if (name.find(':') != std::string::npos) name = "[" + name + "]";
    return fmt::format("http://{}:{}", name, port);
}

}  // namespace item3d
