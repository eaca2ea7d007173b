// Access control: the secret token, the password, and the origin of requests.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace item3d {

/// Headers of a request that identify its sender. A missing header is empty.
struct RequestOrigin {
    std::string host = {};        ///< Host
    std::string origin = {};      ///< Origin
    std::string fetch_site = {};  ///< Sec-Fetch-Site
    std::string cookies = {};     ///< Cookie
    std::string token = {};       ///< X-Item3d-Token
    bool changes = false;         ///< true for all methods but GET and HEAD
};

struct AccessOptions {
    std::string token;     ///< secret in the printed address
    std::string password;  ///< required in place of the token, if not empty
    std::string cookie;    ///< name of the cookie that holds the token
    std::string address;   ///< public address of the page behind a proxy; empty without a proxy
};

/// Access checks. Thread-safe.
class StudioAccess {
  public:
    explicit StudioAccess(AccessOptions options);

    /// Returns the reason to refuse the request whoever sends it, or "" if there is none. The
    /// reasons are that its Host is not this machine (DNS rebinding), or that it comes from another
    /// origin.
    std::string refusal(const RequestOrigin& request) const;
    /// True if the cookie or the header contains the token.
    bool knows_token(const RequestOrigin& request) const;
    /// True if a visit with this token in its query gets the cookie. Always false if there is a
    /// password.
    bool admits(const std::string& token) const;
    /// True if `given` is the password. After a wrong password, all attempts are refused for a
    /// second.
    bool admits_password(const std::string& given);
    bool has_password() const { return !options_.password.empty(); }
    /// Returns the value of the header Set-Cookie.
    std::string cookie() const;

  private:
    bool is_own_host(const std::string& host) const;

    AccessOptions options_;
    std::string machine_;  ///< this machine's name
    std::mutex mutex_;
    std::chrono::steady_clock::time_point refused_until_;
};

}  // namespace item3d
