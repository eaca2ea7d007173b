// Shared helpers of the studio's routes, for access checks, bounded bodies and errors as JSON.
#pragma once

#include "item3d/studio/studio.h"

#include <httplib.h>
#include <nlohmann/json.hpp>

#include <cstdint>
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

/// Adder of routes to the server. The routes act on `studio`. Every route of api/ requires the
/// token.
struct StudioRoutes {
    httplib::Server& server;
    Studio& studio;

    using Answer = std::function<void(const HttpRequest&, HttpResponse&)>;
    using AnswerBody =
        std::function<void(const HttpRequest&, HttpResponse&, const nlohmann::json&)>;
    using AnswerStream =
        std::function<void(const HttpRequest&, HttpResponse&, const httplib::ContentReader&)>;

    void get(const std::string& pattern, Answer answer);
    /// Adds a route whose body is a JSON object of at most a megabyte. An empty body stands for {}.
    void post(const std::string& pattern, AnswerBody answer);
    void patch(const std::string& pattern, AnswerBody answer);
    void remove(const std::string& pattern, Answer answer);
    /// Adds a route whose answer reads the body itself. A body longer than `longest` is refused
    /// before the answer is called.
    void post_stream(const std::string& pattern, std::size_t longest, AnswerStream answer);
};

RequestOrigin origin_of(const HttpRequest& request);
/// Returns the number of a project or a result. Throws nlohmann::json::exception for anything but
/// an integer from 0 on.
std::int64_t id_of(const nlohmann::json& value);
void reply_json(HttpResponse& response, const nlohmann::json& json);
/// Replies {"error", "hint"}.
void reply_error(HttpResponse& response, int status, const std::string& message);
/// Replies with an error and closes the connection, for a request whose body is not read.
void refuse_and_close(HttpResponse& response, int status, const std::string& message);
/// Replies with the status and message of an exception.
void reply_exception(const Studio& studio, HttpResponse& response, std::exception_ptr exception);

/// Returns a number from the route's pattern. If the number is too large, it returns 0, which is no
/// valid id.
std::int64_t number_of(const HttpRequest& request, std::size_t group);
/// Replies without httplib's compression, which is slow.
void reply_bytes(HttpResponse& response, std::string bytes, const std::string& type);
/// Sets the caching headers. Returns true, with the reply set to "not modified", if the browser's
/// copy is current.
bool is_unchanged(const HttpRequest& request, HttpResponse& response,
                  const std::filesystem::path& file);
/// Streams a file that the browser may cache.
void reply_file(const HttpRequest& request, HttpResponse& response,
                const std::filesystem::path& file);
std::string content_type(const std::filesystem::path& file);

}  // namespace item3d
