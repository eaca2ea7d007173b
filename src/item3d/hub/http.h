// HTTP(S) for the Hugging Face hub: redirects, ranges, and a token that is sent only to its host.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

namespace item3d {

/// Failed connection or server error: a retry may help. what() is one line.
class ConnectionError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct HubResponse {
    long status = 0;
    std::map<std::string, std::string> headers;  ///< names in lower case
    std::string url;                             ///< final address, after redirects
    std::string body;                            ///< set by fetch()

    /// Returns "" if absent.
    std::string header(const std::string& name) const;
    /// True if "X-Linked-Etag" and "X-Linked-Size" are present: the hub's own tag and size of a
    /// file that it redirects to another storage.
    bool tells_of_file() const;
};

class HttpClient {
  public:
    /// token: sent only to the scheme, host and port of `endpoint`, never after a redirect
    /// elsewhere; may be empty.
    HttpClient(std::string endpoint, std::string token);
    ~HttpClient();
    HttpClient(const HttpClient&) = delete;
    HttpClient& operator=(const HttpClient&) = delete;

    // The following throw ConnectionError for temporary failures (no connection, cut, too slow,
    // 408, 429, 5xx), InputError for permanent ones (bad address or certificate, a redirect loop, a
    // redirect from https to http), and Interrupted after Ctrl-C. Other statuses are returned.

    /// Requests status and headers only. Follows redirects up to the first response that
    /// tells_of_file().
    HubResponse head(const std::string& url);
    /// Requests a body into memory, at most `max_body` bytes.
    HubResponse fetch(const std::string& url);
    /// Requests the bytes from `offset` on. Calls `begin` with status and headers after redirects,
    /// then `receive` with parts of the body if the status is 200 or 206; both may throw.
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

/// Percent-encodes all but unreserved characters and those in `keep`.
std::string encode_url(const std::string& text, const std::string& keep = "");

}  // namespace item3d
