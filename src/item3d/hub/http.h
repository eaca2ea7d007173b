// An HTTP(S) client for the Hugging Face hub. It follows redirects, requests byte ranges, and sends
// the token only to the hub's own host.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

namespace item3d {

/// A failed connection or an error of the server. A retry may help. what() is one line.
class ConnectionError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct HubResponse {
    long status = 0;
    std::map<std::string, std::string> headers;  ///< names in lower case
    std::string url;                             ///< final address, after redirects
    std::string body;                            ///< set by fetch()

    /// Returns the value of a header; "" if it is absent. name: in lower case.
    std::string header(const std::string& name) const;
    /// True if the headers "X-Linked-Etag" and "X-Linked-Size" are present. They have the hub's own
    /// tag and size of a file for which it redirects to another server.
    bool tells_of_file() const;
};

class HttpClient {
  public:
    /// token: may be empty; sent only to the scheme, host and port of `endpoint`, never after a
    /// redirect to another place.
    HttpClient(std::string endpoint, std::string token);
    ~HttpClient();
    HttpClient(const HttpClient&) = delete;
    HttpClient& operator=(const HttpClient&) = delete;

    // The next three functions throw ConnectionError for temporary failures (no connection, a cut
    // or slow connection, the statuses 408, 429 and 5xx). They throw InputError for permanent
    // failures (a bad address or certificate, a redirect loop, a redirect from https to http), and
    // Interrupted after Ctrl-C. They return any other status.

    /// Requests only status and headers. Follows redirects up to the first response whose
    /// tells_of_file() is true.
    HubResponse head(const std::string& url);
    /// Requests a body of at most `max_body` bytes into memory.
    HubResponse fetch(const std::string& url);
    /// Requests the bytes from `offset` on. After redirects, calls `begin` with status and headers.
    /// If the status is 200 or 206, then calls `receive` with parts of the body. Both callbacks may
    /// throw.
    HubResponse download(const std::string& url, std::uint64_t offset,
                         const std::function<void(const HubResponse&)>& begin,
                         const std::function<void(std::span<const std::uint8_t>)>& receive);

    static constexpr std::size_t max_body = std::size_t(64) << 20;

  private:
    struct Transfer;
    HubResponse follow(Transfer& transfer, std::string url);
    void perform(Transfer& transfer, const std::string& url);

    std::string origin_;
    std::string token_;
    struct Handle;
    std::unique_ptr<Handle> handle_;
};

/// Returns the text with percent-encoding of all characters but the unreserved ones and those in
/// `keep`.
std::string encode_url(const std::string& text, const std::string& keep = "");

}  // namespace item3d
