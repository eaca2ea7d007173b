#include "item3d/studio/access.h"

#include "item3d/serve/secret.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace item3d {
namespace {

/// Returns the "host:port" of an address.
std::string authority_of(const std::string& address) {
    const std::size_t scheme = address.find("://");
    const std::size_t begin = scheme == std::string::npos ? 0 : scheme + 3;
    return address.substr(begin, address.find('/', begin) - begin);
}

/// Returns the host's name in lower case, without the port and without the brackets of an IPv6
/// address.
std::string host_of(std::string authority) {
    std::transform(authority.begin(), authority.end(), authority.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    if (authority.starts_with('[')) {
        const std::size_t end = authority.find(']');
        return end == std::string::npos ? "" : authority.substr(1, end - 1);
    }
    return authority.substr(0, authority.find(':'));
}

/// True for IP addresses, which DNS cannot rebind.
bool is_ip_address(const std::string& host) {
    std::array<unsigned char, sizeof(in6_addr)> address{};
    return ::inet_pton(AF_INET, host.c_str(), address.data()) == 1 ||
           ::inet_pton(AF_INET6, host.c_str(), address.data()) == 1;
}

std::string machine_name() {
    std::array<char, 256> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? host_of(name.data()) : "";
}

/// Returns the value of a cookie; empty if it is missing.
std::string cookie_of(std::string_view cookies, const std::string& name) {
    while (!cookies.empty()) {
        const std::size_t end = std::min(cookies.find(';'), cookies.size());
        std::string_view one = cookies.substr(0, end);
        cookies.remove_prefix(std::min(end + 1, cookies.size()));
        while (one.starts_with(' '))
            one.remove_prefix(1);
        if (one.starts_with(name) && one.substr(name.size()).starts_with('='))
            return std::string(one.substr(name.size() + 1));
    }
    return "";
}

}  // namespace

StudioAccess::StudioAccess(AccessOptions options)
    : options_(std::move(options)), machine_(machine_name()) {}

bool StudioAccess::is_own_host(const std::string& host) const {
    const std::string name = host_of(host);
    if (name.empty()) return false;
    if (name == "localhost" || name.ends_with(".localhost") || is_ip_address(name)) return true;
    return name == machine_ || name == host_of(authority_of(options_.address));
}

std::string StudioAccess::refusal(const RequestOrigin& request) const {
    if (!is_own_host(request.host))
        return "the Host of the request is not a name of this machine; give the public address "
               "with --address";
    if (!request.fetch_site.empty() && request.fetch_site != "same-origin" &&
        request.fetch_site != "none" && request.changes)
        return "the request comes from another site";
    if (request.origin.empty()) return "";
    const std::string from = authority_of(request.origin);
    if (from != request.host && from != authority_of(options_.address))
        return "the request comes from another origin";
    return "";
}

bool StudioAccess::knows_token(const RequestOrigin& request) const {
    return equals_secret(request.token, options_.token) ||
           equals_secret(cookie_of(request.cookies, options_.cookie), options_.token);
}

bool StudioAccess::admits(const std::string& token) const {
    return !has_password() && equals_secret(token, options_.token);
}

bool StudioAccess::admits_password(const std::string& given) {
    constexpr auto pause = std::chrono::seconds(1);
    const std::lock_guard guard(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (!has_password() || now < refused_until_) return false;
    if (equals_secret(given, options_.password)) return true;
    refused_until_ = now + pause;
    return false;
}

std::string StudioAccess::cookie() const {
    const bool encrypted = options_.address.starts_with("https://");
    return options_.cookie + "=" + options_.token + "; HttpOnly; SameSite=Strict" +
           (encrypted ? "; Secure" : "");
}

}  // namespace item3d
