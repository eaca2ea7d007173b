// HTTP(S) as the Hugging Face hub needs it: redirects, ranges, a token that stays with its host.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

namespace item3d {

/// The connection failed or the server was unwell: worth another try. what() is one line.
class ConnectionError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct HubResponse {
    long status = 0;
    std::map<std::string, std::string> headers;  ///< names in lower case
    std::string url;                             ///< where it came from, after redirects
    std::string body;                            ///< of fetch()

    /// "" where it is absent.
    std::string header(const std::string& name) const;
    /// True with "X-Linked-Etag" and "X-Linked-Size": the hub's own tag and size of a file, where
    /// it redirects to storage that knows less.
    bool tells_of_file() const;
};

class HttpClient {
  public:
    /// `token`, if any, is sent to the scheme, host and port of `endpoint` and nowhere else, not
    /// even where that redirects to.
    HttpClient(std::string endpoint, std::string token);
    ~HttpClient();
    HttpClient(const HttpClient&) = delete;
    HttpClient& operator=(const HttpClient&) = delete;

    // The following throw ConnectionError for what may pass (no connection, cut, too slow, 408,
    // 429, 5xx), InputError for what will not (bad address or certificate, redirects in circles or
    // from https to http), and Interrupted after Ctrl-C. Other statuses are returned.

    /// Status and headers alone. Redirects are followed up to the first answer that
    /// tells_of_file().
    HubResponse head(const std::string& url);
    /// With the body in memory, at most `max_body` bytes.
    HubResponse fetch(const std::string& url);
    /// Asks for the bytes from `offset` on. `begin` gets status and headers once redirects are
    /// over, then `receive` the body piece by piece if the status is 200 or 206; both may throw.
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
