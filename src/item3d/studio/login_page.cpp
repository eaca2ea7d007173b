#include "item3d/studio/login_page.h"

#include "item3d/core/html_escape.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <charconv>

namespace item3d {
namespace {

constexpr const char* style =
    "body{font:16px/1.5 system-ui,sans-serif;max-width:34rem;margin:15vh auto;padding:0 1rem;"
    "color-scheme:light dark}input,button{font:inherit;padding:.4rem .6rem}";

/// Returns a page whose form sends its origin. The server's own referrer policy would suppress the
/// origin.
std::string small_page(const std::string& content) {
    return fmt::format(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"referrer\" "
        "content=\"same-origin\"><meta name=\"viewport\" "
        "content=\"width=device-width\"><link rel=\"icon\" href=\"data:,\"><title>item3d "
        "studio</title><style>{}</style>"
        "<h1>item3d studio</h1>{}</html>\n",
        style, content);
}

std::string base64_sha256(const std::string& text) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr);
    std::array<unsigned char, 4 * EVP_MAX_MD_SIZE / 3 + 4> encoded{};
    const int length = EVP_EncodeBlock(encoded.data(), digest.data(), static_cast<int>(size));
    return std::string(encoded.begin(), encoded.begin() + length);
}

}  // namespace

std::string login_page(const std::string& problem) {
    return small_page(fmt::format(
        "<p>{}</p><form method=\"post\" action=\"login\"><label>Password <input type=\"password\" "
        "name=\"password\" autocomplete=\"current-password\" autofocus></label> "
        "<button>Open</button></form>",
        html_escape(problem)));
}

std::string refused_page(const std::string& why) {
    return small_page(fmt::format("<p>{}</p>", html_escape(why)));
}

std::string password_of_form(const std::string& body) {
    constexpr std::string_view field = "password=";
    if (!body.starts_with(field)) return "";
    std::string password;
    for (std::size_t i = field.size(); i < body.size() && body[i] != '&'; ++i) {
        unsigned char code = 0;
        const char* digits = body.data() + i + 1;
        if (body[i] == '%' && i + 2 < body.size() &&
            std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
            password += static_cast<char>(code);
            i += 2;
        } else {
            password += body[i] == '+' ? ' ' : body[i];
        }
    }
    return password;
}

std::string page_policy(const std::string& page) {
    std::string scripts = "'self'";
    constexpr std::string_view begin = "<script type=\"importmap\">", end = "</script>";
    for (std::size_t at = 0; (at = page.find(begin, at)) != std::string::npos;) {
        at += begin.size();
        const std::size_t length = page.find(end, at) - at;
        scripts += fmt::format(" 'sha256-{}'", base64_sha256(page.substr(at, length)));
    }
    return fmt::format(
        "default-src 'self'; script-src {}; img-src 'self' data: blob:; connect-src 'self' data: "
        "blob:; style-src 'self' 'unsafe-inline'; worker-src 'self' blob:; object-src 'none'; "
        "base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
        scripts);
}

}  // namespace item3d
