// A cpp-httplib server that listens on a socket, in its own threads.
#pragma once

#include <memory>
#include <string>
#include <thread>

namespace httplib {
class Server;
class TaskQueue;
}  // namespace httplib

namespace item3d {

/// HTTP server that listens while this object exists. No other program can use its port.
class HttpListener {
  public:
    /// server must already have its handlers, and must outlive this object. threads: number of
    /// connections that are served at a time; others wait. Port 0 selects a free port. Throws
    /// ResourceError if the port is taken or too few files can be open, std::system_error if a
    /// thread cannot be started, and InputError if the machine has no such host.
    HttpListener(httplib::Server& server, const std::string& host, int port, int threads);
    /// Blocks until pending replies are sent.
    ~HttpListener();
    HttpListener(const HttpListener&) = delete;
    HttpListener& operator=(const HttpListener&) = delete;

    int port() const { return port_; }

  private:
    httplib::Server& server_;
    std::unique_ptr<httplib::TaskQueue> connections_;  ///< empty while the server listens
    int port_ = 0;
    std::thread thread_;
};

/// Returns "http://HOST:PORT", with this machine's name as HOST if `host` is a wildcard address
/// ("0.0.0.0" or "::").
std::string server_address(const std::string& host, int port);
/// True if other machines cannot reach this host.
bool is_loopback(const std::string& host);

}  // namespace item3d
