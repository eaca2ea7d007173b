// Passes bytes to the routes of a server as a request, without a socket.
#pragma once

#include "tests/fuzz/fuzz.h"

#include <httplib.h>

#include <algorithm>
#include <string>

namespace item3d::fuzz {

/// A connection from which a whole request can be read. It discards the answer.
class OneRequest : public httplib::Stream {
  public:
    explicit OneRequest(std::string request) : request_(std::move(request)) {}
    bool is_readable() const override { return true; }
    bool is_writable() const override { return true; }
    ssize_t read(char* into, std::size_t size) override {
        const std::size_t count = request_.copy(into, size, at_);
        at_ += count;
        return static_cast<ssize_t>(count);
    }
    ssize_t write(const char*, std::size_t size) override { return static_cast<ssize_t>(size); }
    void get_remote_ip_and_port(std::string& ip, int& port) const override { local(ip, port); }
    void get_local_ip_and_port(std::string& ip, int& port) const override { local(ip, port); }
    socket_t socket() const override { return -1; }

  private:
    static void local(std::string& ip, int& port) {
        ip = "127.0.0.1";
        port = 1;
    }
    std::string request_;
    std::size_t at_ = 0;
};

class OpenServer : public httplib::Server {
  public:
    void answer(const std::string& request, const std::function<void(httplib::Request&)>& change) {
        OneRequest stream(request);
        bool is_closed = false;
        process_request(stream, true, is_closed, change);
    }
};

}  // namespace item3d::fuzz
