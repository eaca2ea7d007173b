#include "item3d/studio/http.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/io/text.h"

#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <limits>
#include <map>
#include <utility>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t longest_json = 1 << 20;

std::string refusal_of(Studio& studio, const HttpRequest& request) {
    const RequestOrigin origin = origin_of(request);
    std::string refusal = studio.access().refusal(origin);
    if (refusal.empty() && !studio.access().knows_token(origin))
        refusal = "the token is missing or wrong; open the address that item3d studio printed";
    return refusal;
}

/// Returns status and message of an exception.
std::pair<int, std::string> refusal_of_exception(const Studio& studio,
                                                 std::exception_ptr exception) {
    const auto say = [&](int status, const std::string& message) {
        return std::pair{status, studio.folders().without_paths(message)};
    };
    try {
        std::rethrow_exception(exception);
    } catch (const ResourceError& error) {
        return say(http_status::no_storage, error.what());
    } catch (const Error& error) {
        return say(http_status::bad_request, error.what());
    } catch (const fs::filesystem_error& error) {
        if (error.code() == std::errc::no_space_on_device)
            return say(http_status::no_storage, message_of(error));
        return say(error.code() == std::errc::filename_too_long ? http_status::bad_request
                                                                : http_status::failed,
                   message_of(error));
    } catch (const Json::exception& error) {
        return say(http_status::bad_request, "the request is not valid");
    } catch (const std::exception& error) {
        warn(error.what());
        return say(http_status::failed, error.what());
    }
}

/// Calls the answer if the request is permitted; an exception becomes the reply.
void answer_guarded(Studio& studio, const HttpRequest& request, HttpResponse& response,
                    const std::function<void()>& answer) {
    try {
        if (const std::string refusal = refusal_of(studio, request); !refusal.empty())
            reply_error(response, http_status::forbidden, refusal);
        else
            answer();
    } catch (...) {
        reply_exception(studio, response, std::current_exception());
    }
}

std::size_t stated_length(const HttpRequest& request) {
    return static_cast<std::size_t>(request.get_header_value<std::uint64_t>("Content-Length"));
}

/// Reads a body of at most `longest` bytes. Returns false if it is longer.
bool read_body(const httplib::ContentReader& reader, std::size_t longest, std::string& body) {
    return reader([&](const char* data, std::size_t size) {
        if (body.size() + size > longest) return false;
        body.append(data, size);
        return true;
    });
}

/// Refuses a request. A short body is read first, since a browser that is still sending when the
/// connection closes never sees the reply.
void refuse(const HttpRequest& request, HttpResponse& response,
            const httplib::ContentReader& reader, int status, const std::string& message) {
    constexpr std::size_t max_drained = std::size_t{8} << 20;
    std::size_t drained = 0;
    const bool is_read =
        stated_length(request) <= max_drained && reader([&](const char*, std::size_t size) {
            drained += size;
            return drained <= max_drained;
        });
    if (is_read)
        reply_error(response, status, message);
    else
        refuse_and_close(response, status, message);
}

httplib::Server::HandlerWithContentReader json_handler(Studio& studio,
                                                       StudioRoutes::AnswerBody answer) {
    return [&studio, answer = std::move(answer)](const HttpRequest& request, HttpResponse& response,
                                                 const httplib::ContentReader& reader) {
        constexpr const char* too_long = "the request is larger than one megabyte";
        std::string body;
        if (stated_length(request) > longest_json) {
            refuse(request, response, reader, http_status::too_large, too_long);
            return;
        }
        if (!read_body(reader, longest_json, body)) {
            refuse_and_close(response, http_status::too_large, too_long);
            return;
        }
        answer_guarded(studio, request, response, [&] {
            const Json json = body.empty() ? Json::object() : parse_json(body);
            if (!json.is_object()) throw InputError("request", "expected a JSON object");
            answer(request, response, json);
        });
    };
}

/// Returns {"error", "hint"} by splitting a message of this program at its last "; ".
Json error_json(const std::string& message) {
    const std::size_t parted = message.rfind("; ");
    return {{"error", message.substr(0, parted)},
            {"hint", parted == std::string::npos ? "" : message.substr(parted + 2)}};
}

std::string etag_of(const fs::path& file) {
    return fmt::format("\"{:x}-{:x}\"", fs::file_size(file),
                       fs::last_write_time(file).time_since_epoch().count());
}

}  // namespace

void StudioRoutes::get(const std::string& pattern, Answer answer) {
    server.Get(pattern, [answer = std::move(answer), &studio = studio](const HttpRequest& request,
                                                                       HttpResponse& response) {
        answer_guarded(studio, request, response, [&] { answer(request, response); });
    });
}

void StudioRoutes::post(const std::string& pattern, AnswerBody answer) {
    server.Post(pattern, json_handler(studio, std::move(answer)));
}

void StudioRoutes::patch(const std::string& pattern, AnswerBody answer) {
    server.Patch(pattern, json_handler(studio, std::move(answer)));
}

void StudioRoutes::remove(const std::string& pattern, Answer answer) {
    server.Delete(pattern,
                  json_handler(studio, [answer = std::move(answer)](
                                           const HttpRequest& request, HttpResponse& response,
                                           const Json&) { answer(request, response); }));
}

void StudioRoutes::post_stream(const std::string& pattern, std::size_t longest,
                               AnswerStream answer) {
    server.Post(pattern, [&studio = studio, longest, answer = std::move(answer)](
                             const HttpRequest& request, HttpResponse& response,
                             const httplib::ContentReader& reader) {
        if (const std::string refusal = refusal_of(studio, request); !refusal.empty()) {
            refuse(request, response, reader, http_status::forbidden, refusal);
        } else if (stated_length(request) > longest) {
            refuse(request, response, reader, http_status::too_large,
                   fmt::format("the upload is larger than {} MB; make its textures smaller",
                               longest >> 20));
        } else {
            try {
                answer(request, response, reader);
            } catch (...) {
                // The error may come in the middle of the body. No request can follow after that.
                const auto [status, message] =
                    refusal_of_exception(studio, std::current_exception());
                refuse_and_close(response, status, message);
            }
        }
    });
}

std::int64_t id_of(const nlohmann::json& value) {
    return integer_of(value, 0, std::numeric_limits<std::int64_t>::max());
}

RequestOrigin origin_of(const HttpRequest& request) {
    return {request.get_header_value("Host"),
            request.get_header_value("Origin"),
            request.get_header_value("Sec-Fetch-Site"),
            request.get_header_value("Cookie"),
            request.get_header_value("X-Item3d-Token"),
            request.method != "GET" && request.method != "HEAD"};
}

void reply_json(HttpResponse& response, const Json& json) {
    response.set_header("Cache-Control", "no-store");
    reply_bytes(response, json.dump(-1, ' ', false, Json::error_handler_t::replace),
                "application/json");
}

void reply_error(HttpResponse& response, int status, const std::string& message) {
    response.status = status;
    reply_json(response, error_json(message));
}

void refuse_and_close(HttpResponse& response, int status, const std::string& message) {
    const std::string body =
        error_json(message).dump(-1, ' ', false, Json::error_handler_t::replace);
    response.status = status;
    response.set_header("Cache-Control", "no-store");
    response.set_header("Connection", "close");
    // If the provider ends after its last byte, httplib closes the connection.
    response.set_content_provider(
        body.size(), "application/json",
        [body](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
            sink.write(body.data() + offset, length);
            return false;
        });
}

void reply_exception(const Studio& studio, HttpResponse& response, std::exception_ptr exception) {
    const auto [status, message] = refusal_of_exception(studio, exception);
    reply_error(response, status, message);
}

std::int64_t number_of(const HttpRequest& request, std::size_t group) {
    const std::string text = request.matches[group].str();
    std::int64_t number = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
    return parsed.ec == std::errc() ? number : 0;
}

std::string content_type(const fs::path& file) {
    static const std::map<std::string, std::string> types = {
        {".html", "text/html; charset=utf-8"},
        {".js", "text/javascript; charset=utf-8"},
        {".mjs", "text/javascript; charset=utf-8"},
        {".css", "text/css; charset=utf-8"},
        {".json", "application/json"},
        {".svg", "image/svg+xml"},
        {".png", "image/png"},
        {".jpg", "image/jpeg"},
        {".webp", "image/webp"},
        {".glb", "model/gltf-binary"},
        {".vrm", "model/gltf-binary"},
        {".txt", "text/plain; charset=utf-8"},
        {".webmanifest", "application/manifest+json"}};
    const auto type = types.find(to_lower(file.extension().string()));
    return type == types.end() ? "application/octet-stream" : type->second;
}

bool is_unchanged(const HttpRequest& request, HttpResponse& response, const fs::path& file) {
    const std::string tag = etag_of(file);
    response.set_header("ETag", tag);
    response.set_header("Cache-Control", "no-cache");
    if (request.get_header_value("If-None-Match") != tag) return false;
    response.status = http_status::not_modified;
    return true;
}

void reply_bytes(HttpResponse& response, std::string bytes, const std::string& type) {
    if (bytes.empty()) {
        response.set_content("", type);
        return;
    }
    auto kept = std::make_shared<const std::string>(std::move(bytes));
    response.set_content_provider(
        kept->size(), type,
        [kept](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
            return sink.write(kept->data() + offset, length);
        });
}

void reply_file(const HttpRequest& request, HttpResponse& response, const fs::path& file) {
    std::error_code code;
    if (!fs::is_regular_file(file, code)) {
        reply_error(response, http_status::not_found, "no such file");
        return;
    }
    if (is_unchanged(request, response, file)) return;
    auto stream = std::make_shared<std::ifstream>(file, std::ios::binary);
    const std::size_t size = fs::file_size(file);
    if (size == 0) {
        response.set_content("", content_type(file));
        return;
    }
    response.set_content_provider(
        size, content_type(file),
        [stream](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
            std::string piece(std::min<std::size_t>(length, 1 << 16), '\0');
            stream->seekg(static_cast<std::streamoff>(offset));
            stream->read(piece.data(), static_cast<std::streamsize>(piece.size()));
            return *stream && sink.write(piece.data(), piece.size());
        });
}

}  // namespace item3d
