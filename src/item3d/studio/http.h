// What the studio's routes share: who may ask, bodies within bounds, errors as JSON.
#pragma once

#include "item3d/studio/studio.h"

#include <httplib.h>
#include <nlohmann/json.hpp>

#include <functional>
#include <string>

namespace item3d {

using HttpRequest = httplib::Request;
using HttpResponse = httplib::Response;

namespace http_status {
inline constexpr int see_other = 303, not_modified = 304, bad_request = 400, forbidden = 403;
inline constexpr int not_found = 404, too_large = 413, failed = 500, unavailable = 503;
inline constexpr int no_storage = 507;
}  // namespace http_status

/// Routes of the server, with the studio that answers. Every route of api/ asks for the token.
struct StudioRoutes {
    httplib::Server& server;
    Studio& studio;

    using Answer = std::function<void(const HttpRequest&, HttpResponse&)>;
    using AnswerBody =
        std::function<void(const HttpRequest&, HttpResponse&, const nlohmann::json&)>;
    using AnswerStream =
        std::function<void(const HttpRequest&, HttpResponse&, const httplib::ContentReader&)>;

    void get(const std::string& pattern, Answer answer);
    /// Bodies are JSON objects of at most a megabyte; an empty one is {}.
    void post(const std::string& pattern, AnswerBody answer);
    void patch(const std::string& pattern, AnswerBody answer);
    void remove(const std::string& pattern, Answer answer);
    /// The body is read by the answer; longer ones than `longest` are refused before.
    void post_stream(const std::string& pattern, std::size_t longest, AnswerStream answer);
};

RequestOrigin origin_of(const HttpRequest& request);
void reply_json(HttpResponse& response, const nlohmann::json& json);
/// {"error", "hint"}.
void reply_error(HttpResponse& response, int status, const std::string& message);
/// The same, and the connection is closed: of a request whose body is not read.
void refuse_and_close(HttpResponse& response, int status, const std::string& message);
/// The page's answer to what was thrown.
void reply_exception(const Studio& studio, HttpResponse& response, std::exception_ptr exception);

/// A number of the route's pattern; 0, which nothing has, where it is too large.
std::int64_t number_of(const HttpRequest& request, std::size_t group);
/// Not compressed by httplib, which takes its time.
void reply_bytes(HttpResponse& response, std::string bytes, const std::string& type);
/// Sets the headers by which the browser asks whether a file has changed; true where it has not,
/// which is then the answer.
bool is_unchanged(const HttpRequest& request, HttpResponse& response,
                  const std::filesystem::path& file);
/// Streams a file that may be kept by the browser.
void reply_file(const HttpRequest& request, HttpResponse& response,
                const std::filesystem::path& file);
std::string content_type(const std::filesystem::path& file);

}  // namespace item3d
