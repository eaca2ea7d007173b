#include "item3d/serve/http_listener.h"

#include "item3d/core/error.h"

#include <fmt/format.h>
#include <httplib.h>
#include <netinet/tcp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <functional>
#include <mutex>
#include <queue>
#include <utility>
#include <vector>

namespace item3d {
namespace {

/// Backlog of the socket. With httplib's backlog of five, connections are lost under load.
constexpr int max_waiting = 1024;

/// Throws ResourceError if so few files can be open that no connection could be accepted. Without
/// this check, clients would wait until they give up.
void check_file_limit() {
    constexpr rlim_t min_files = 64;
    rlimit files{};
    if (::getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < min_files)
        throw ResourceError(fmt::format(
            "only {} files can be open at a time, too few for a server; allow at least {} with "
            "'ulimit -n {}'",
            files.rlim_cur, min_files, min_files));
}

/// Sets SO_REUSEADDR only. With SO_REUSEPORT, httplib's default, two programs would share the port.
void set_listener_options(socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
}

/// Threads that serve connections. httplib's own pool starts its threads only when the server
/// listens, and ends the program if one of them cannot be started.
class ConnectionThreads : public httplib::TaskQueue {
  public:
    /// Throws std::system_error if a thread cannot be started.
    explicit ConnectionThreads(int count) {
        for (int i = 0; i < count; ++i)
            threads_.emplace_back([this](const std::stop_token& stop) { serve(stop); });
    }
    ~ConnectionThreads() override { shutdown(); }
    ConnectionThreads(const ConnectionThreads&) = delete;
    ConnectionThreads& operator=(const ConnectionThreads&) = delete;

    void enqueue(std::function<void()> connection) override {
        const std::lock_guard lock(mutex_);
        waiting_.push(std::move(connection));
        changed_.notify_one();
    }

    /// Blocks until all connections are served.
    void shutdown() override {
        for (std::jthread& thread : threads_)
            thread.request_stop();
        threads_.clear();
    }

  private:
    void serve(const std::stop_token& stop) {
        while (true) {
            std::unique_lock lock(mutex_);
            if (!changed_.wait(lock, stop, [this] { return !waiting_.empty(); })) return;
            const std::function<void()> connection = std::move(waiting_.front());
            waiting_.pop();
            lock.unlock();
            connection();
        }
    }

    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::queue<std::function<void()>> waiting_;
    std::vector<std::jthread> threads_;  // last: they use all members above
};

std::unique_ptr<httplib::TaskQueue> start_connections(int threads) {
    check_file_limit();
    return std::make_unique<ConnectionThreads>(threads);
}

}  // namespace

HttpListener::HttpListener(httplib::Server& server, const std::string& host, int port, int threads)
    : server_(server), connections_(start_connections(threads)) {
    server.new_task_queue = [this] { return connections_.release(); };  // httplib deletes it
    socket_t listening = -1;  // the last socket that was tried
    server.set_socket_options([&listening](socket_t socket) {
        set_listener_options(socket);
        listening = socket;
    });
    server.set_tcp_nodelay(true);
    errno = 0;
    if (port == 0)
        port_ = server.bind_to_any_port(host);
    else
        port_ = server.bind_to_port(host, port) ? port : -1;
    if (port_ < 0) {
        if (errno == EADDRINUSE)
            throw ResourceError(fmt::format(
                "port {} of {} is in use by another program; choose another with --port", port,
                host));
        throw InputError("--host " + host,
                         fmt::format("port {} cannot be opened ({})", port,
                                     errno != 0 ? std::strerror(errno) : "no such host"),
                         "use an address of this machine");
    }
    ::listen(listening, max_waiting);
    server.set_socket_options(set_listener_options);
    thread_ = std::thread([&server] { server.listen_after_bind(); });
    while (!server.is_running())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

HttpListener::~HttpListener() {
    server_.stop();
    thread_.join();
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
