// A cpp-httplib server on a socket, in threads of its own.
#pragma once

#include <memory>
#include <string>
#include <thread>

namespace httplib {
class Server;
}

namespace item3d {

/// Answers requests from the constructor to the destructor. The port is this program's alone.
class HttpListener {
  public:
    /// server: with its handlers; outlives it. threads: connections that are answered at a time;
    /// the others wait. port 0: a free one. Throws ResourceError where the port is taken and
    /// InputError where the machine has no such host.
    HttpListener(httplib::Server& server, const std::string& host, int port, int threads);
    /// Waits for the answers that are under way.
    ~HttpListener();
    HttpListener(const HttpListener&) = delete;
    HttpListener& operator=(const HttpListener&) = delete;

    int port() const { return port_; }

  private:
    httplib::Server& server_;
    int port_ = 0;
    std::thread thread_;
};

/// "http://HOST:PORT", with this machine's name where the host stands for all of its addresses.
std::string server_address(const std::string& host, int port);
/// Whether other machines cannot reach this host.
bool is_loopback(const std::string& host);

}  // namespace item3d
