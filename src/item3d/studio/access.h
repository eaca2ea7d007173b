// Who may ask: the secret of the address, the password, and where requests come from.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace item3d {

/// The headers of a request that say who asks, empty where they are not there.
struct RequestOrigin {
    std::string host = {};        ///< Host
    std::string origin = {};      ///< Origin
    std::string fetch_site = {};  ///< Sec-Fetch-Site
    std::string cookies = {};     ///< Cookie
    std::string token = {};       ///< X-Item3d-Token
    bool changes = false;         ///< is no GET or HEAD
};

struct AccessOptions {
    std::string token;     ///< in the address that is printed
    std::string password;  ///< asked for in place of the token; empty: none
    std::string cookie;    ///< name of the cookie that holds the token
    std::string address;   ///< by which people reach the page, where a proxy is before it; or empty
};

/// Thread-safe.
class StudioAccess {
  public:
    explicit StudioAccess(AccessOptions options);

    /// Why the request is refused whoever sends it: its Host is none of this machine's (another
    /// site's name was made to lead here), or it comes from another origin. Empty: it is not.
    std::string refusal(const RequestOrigin& request) const;
    /// Whether the cookie or the header has the token.
    bool knows_token(const RequestOrigin& request) const;
    /// Whether a visit by this query may have the cookie. Never with a password.
    bool admits(const std::string& token) const;
    /// Whether this is the password. After a wrong one all are refused for a second.
    bool admits_password(const std::string& given);
    bool has_password() const { return !options_.password.empty(); }
    /// The value of Set-Cookie.
    std::string cookie() const;

  private:
    bool is_own_host(const std::string& host) const;

    AccessOptions options_;
    std::string machine_;  ///< this machine's name
    std::mutex mutex_;
    std::chrono::steady_clock::time_point refused_until_;
};

}  // namespace item3d
