#include "item3d/hub/http.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/core/version.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <exception>
#include <filesystem>

namespace item3d {
namespace {

constexpr int max_redirects = 10;
constexpr long connect_seconds = 20;
/// Time in seconds after which a connection that transfers nothing is cut.
constexpr long silent_seconds = 30;

/// Returns the file of the system's certificates. $SSL_CERT_FILE has priority. Otherwise the place
/// depends on the Linux distribution, and the one built into libcurl may be wrong. Empty if there
/// is no file; libcurl then reports the error.
std::string certificates() {
    if (const char* given = std::getenv("SSL_CERT_FILE"); given && *given) return given;
    for (const char* file : {"/etc/ssl/certs/ca-certificates.crt",  // Debian, Arch, Alpine
                             "/etc/pki/tls/certs/ca-bundle.crt",    // Fedora, RHEL
                             "/etc/ssl/ca-bundle.pem"})             // openSUSE
        if (std::error_code code; std::filesystem::exists(file, code)) return file;
    return "";
}

bool is_redirect(long status) {
    return status == 301 || status == 302 || status == 303 || status == 307 || status == 308;
}

std::string trimmed(const std::string& text) {
    const char* blanks = " \t\r\n";
    const auto begin = text.find_first_not_of(blanks);
    if (begin == std::string::npos) return "";
    return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// Returns "scheme://host:port" in lower case, always with the port.
std::string origin_of(const std::string& url) {
    const std::unique_ptr<CURLU, decltype(&curl_url_cleanup)> parsed(curl_url(), &curl_url_cleanup);
    const auto part = [&](CURLUPart what, unsigned int flags) {
        char* text = nullptr;
        if (curl_url_get(parsed.get(), what, &text, flags) != CURLUE_OK) return std::string();
        std::string result = text;
        curl_free(text);
        std::transform(result.begin(), result.end(), result.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return result;
    };
    if (curl_url_set(parsed.get(), CURLUPART_URL, url.c_str(), 0) != CURLUE_OK)
        throw InputError(url, "is not a valid address",
                         "expected an address such as https://huggingface.co");
    const std::string scheme = part(CURLUPART_SCHEME, 0);
    if (scheme != "https" && scheme != "http")
        throw InputError(url, "is not an http or https address");
    return scheme + "://" + part(CURLUPART_HOST, 0) + ":" +
           part(CURLUPART_PORT, CURLU_DEFAULT_PORT);
}

/// True for errors that a retry cannot fix.
bool is_permanent(CURLcode code) {
    return code == CURLE_PEER_FAILED_VERIFICATION || code == CURLE_SSL_CACERT_BADFILE ||
           code == CURLE_URL_MALFORMAT || code == CURLE_UNSUPPORTED_PROTOCOL;
}

}  // namespace

std::string HubResponse::header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? "" : found->second;
}

bool HubResponse::tells_of_file() const {
    return !header("x-linked-etag").empty() && !header("x-linked-size").empty();
}

std::string encode_url(const std::string& text, const std::string& keep) {
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain =
            byte < 128 && (std::isalnum(byte) || std::string("-._~").find(c) != std::string::npos ||
                           keep.find(c) != std::string::npos);
        result += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
    }
    return result;
}

struct HttpClient::Handle {
    Handle() {
        static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
        curl = ready == CURLE_OK ? curl_easy_init() : nullptr;
        if (!curl) throw ResourceError("libcurl cannot be initialized");
    }
    ~Handle() { curl_easy_cleanup(curl); }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    CURL* curl;
};

/// One request and its result. Exceptions of callbacks are stored here until libcurl, which is C,
/// returns.
struct HttpClient::Transfer {
    bool head = false;
    std::uint64_t offset = 0;
    std::function<void(const HubResponse&)> begin;
    std::function<void(std::span<const std::uint8_t>)> receive;

    HubResponse response;
    std::string redirect;
    bool begun = false;
    std::exception_ptr failure;

    template <typename Action>
    bool guarded(const Action& action) {
        try {
            action();
            return true;
        } catch (...) {
            failure = std::current_exception();
            return false;
        }
    }

    static std::size_t on_header(char* text, std::size_t, std::size_t size, void* user) {
        auto& self = *static_cast<Transfer*>(user);
        const std::string line(text, size);
        const auto colon = line.find(':');
        const bool fits = self.guarded([&] {
            if (line.starts_with("HTTP/")) {
                // The status is read here, because libcurl reports it only after the body.
                const auto space = line.find(' ');
                self.response.headers.clear();
                self.response.status =
                    space == std::string::npos ? 0 : std::atol(line.c_str() + space);
                return;
            }
            if (colon == std::string::npos) return;
            std::string name = line.substr(0, colon);
            std::transform(name.begin(), name.end(), name.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
            self.response.headers[name] = trimmed(line.substr(colon + 1));
        });
        return fits ? size : 0;
    }

    static std::size_t on_body(char* bytes, std::size_t, std::size_t size, void* user) {
        auto& self = *static_cast<Transfer*>(user);
        if (self.response.status != 200 && self.response.status != 206) return size;
        const bool taken = self.guarded([&] {
            self.start();
            if (self.receive) self.receive({reinterpret_cast<std::uint8_t*>(bytes), size});
        });
        return taken ? size : 0;
    }

    static int on_progress(void*, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
        return interrupted() ? 1 : 0;
    }

    void start() {
        if (begun) return;
        begun = true;
        if (begin) begin(response);
    }
};

HttpClient::HttpClient(std::string endpoint, std::string token)
    : origin_(origin_of(endpoint)), token_(std::move(token)), handle_(std::make_unique<Handle>()) {
    const bool sendable = std::all_of(token_.begin(), token_.end(),
                                      [](unsigned char c) { return c > ' ' && c < 127; });
    if (!sendable)
        throw InputError("HF_TOKEN", "contains characters that are not allowed in a token",
                         "copy it again from the hub's settings");
}

HttpClient::~HttpClient() = default;

void HttpClient::perform(Transfer& transfer, const std::string& url) {
    CURL* curl = handle_->curl;
    // This resets the options of the last request but keeps its connection.
    curl_easy_reset(curl);
    const std::string agent = "item3d/" + std::string(version());
    std::array<char, CURL_ERROR_SIZE> reason{};
    const std::string authorities = certificates();
    if (!authorities.empty()) curl_easy_setopt(curl, CURLOPT_CAINFO, authorities.c_str());
    curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
    curl_easy_setopt(curl, CURLOPT_USERAGENT, agent.c_str());
    curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, connect_seconds);
    curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, silent_seconds);
    curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, &Transfer::on_progress);
    curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, &Transfer::on_header);
    curl_easy_setopt(curl, CURLOPT_HEADERDATA, &transfer);
    curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &Transfer::on_body);
    curl_easy_setopt(curl, CURLOPT_WRITEDATA, &transfer);
    curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, reason.data());
    if (transfer.head) curl_easy_setopt(curl, CURLOPT_NOBODY, 1L);
    const std::string range = fmt::format("{}-", transfer.offset);
    if (transfer.offset > 0) curl_easy_setopt(curl, CURLOPT_RANGE, range.c_str());
    if (!token_.empty() && origin_of(url) == origin_) {
        curl_easy_setopt(curl, CURLOPT_HTTPAUTH, static_cast<long>(CURLAUTH_BEARER));
        curl_easy_setopt(curl, CURLOPT_XOAUTH2_BEARER, token_.c_str());
    }

    transfer.response = {};
    transfer.response.url = url;
    transfer.redirect.clear();
    const CURLcode code = curl_easy_perform(curl);
    if (transfer.failure) std::rethrow_exception(transfer.failure);
    if (interrupted()) throw Interrupted("during the download");
    const std::string host = origin_of(url);
    if (code != CURLE_OK) {
        const std::string why = reason[0] != 0 ? reason.data() : curl_easy_strerror(code);
        if (is_permanent(code))
            throw InputError(host, why, "check HF_ENDPOINT and the CA certificates");
        throw ConnectionError(host + ": " + why);
    }
    char* location = nullptr;
    curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &transfer.response.status);
    curl_easy_getinfo(curl, CURLINFO_REDIRECT_URL, &location);
    if (location) transfer.redirect = location;
    const long status = transfer.response.status;
    if (status >= 500 || status == 429 || status == 408)
        throw ConnectionError(fmt::format("{}: answered with status {}", host, status));
}

HubResponse HttpClient::follow(Transfer& transfer, std::string url) {
    for (int i = 0; i <= max_redirects; ++i) {
        perform(transfer, url);
        const HubResponse& response = transfer.response;
        const bool told = transfer.head && response.tells_of_file();
        if (!is_redirect(response.status) || transfer.redirect.empty() || told) {
            if (response.status == 200 || response.status == 206) transfer.start();
            return response;
        }
        if (url.starts_with("https:") && !transfer.redirect.starts_with("https:"))
            throw InputError(origin_of(url), "redirects from https to an unencrypted address",
                             "check HF_ENDPOINT");
        url = transfer.redirect;
    }
    throw InputError(origin_of(url), "redirects in a loop", "check HF_ENDPOINT");
}

HubResponse HttpClient::head(const std::string& url) {
    Transfer transfer;
    transfer.head = true;
    return follow(transfer, url);
}

HubResponse HttpClient::fetch(const std::string& url) {
    Transfer transfer;
    std::string body;
    transfer.receive = [&](std::span<const std::uint8_t> bytes) {
        if (body.size() + bytes.size() > max_body)
            throw InputError(url, fmt::format("sends more than {} bytes", max_body));
        body.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    HubResponse response = follow(transfer, url);
    response.body = std::move(body);
    return response;
}

HubResponse HttpClient::download(
    const std::string& url, std::uint64_t offset,
    const std::function<void(const HubResponse&)>& begin,
    const std::function<void(std::span<const std::uint8_t>)>& receive) {
    Transfer transfer;
    transfer.offset = offset;
    transfer.begin = begin;
    transfer.receive = receive;
    return follow(transfer, url);
}

}  // namespace item3d
