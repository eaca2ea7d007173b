// A small Hugging Face hub on the loopback interface: a server for the API, and a second server for
// large files.
#pragma once

#include "item3d/core/digest.h"
#include "item3d/hub/pull.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace item3d::testing {

namespace fs = std::filesystem;

inline std::string digest_of(const std::string& bytes, DigestKind kind) {
    Digest digest(kind, bytes.size());
    digest.update({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    return digest.finish();
}

/// httplib server that runs in its own thread on a free port.
class LoopbackServer {
  public:
    LoopbackServer() { server.set_keep_alive_max_count(1); }
    ~LoopbackServer() {
        server.stop();
        if (thread_.joinable()) thread_.join();
    }
    LoopbackServer(const LoopbackServer&) = delete;
    LoopbackServer& operator=(const LoopbackServer&) = delete;
    void start() {
        port_ = server.bind_to_any_port("127.0.0.1");
        thread_ = std::thread([this] { server.listen_after_bind(); });
        while (!server.is_running())
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::string url() const { return fmt::format("http://127.0.0.1:{}", port_); }

    httplib::Server server;

  private:
    int port_ = 0;
    std::thread thread_;
};

class FakeHub {
  public:
    static constexpr const char* repository = "someone/model";
    static constexpr const char* commit = "0123456789abcdef0123456789abcdef01234567";

    FakeHub() {
        endpoint_.server.Get(
            R"(/api/models/someone/model/revision/(.*))",
            [this](const auto& request, auto& response) { answer_list(request, response); });
        endpoint_.server.Get(
            fmt::format("/someone/model/resolve/{}/(.*)", commit),
            [this](const auto& request, auto& response) { answer_file(request, response); });
        storage_.server.Get("/(.*)", [this](const auto& request, auto& response) {
            answer_large_file(request, response);
        });
        endpoint_.start();
        storage_.start();
    }

    /// Adds a file to the repository. add_large() adds a file that git stores as a pointer (LFS).
    void add(const std::string& path, const std::string& bytes) { files_[path] = bytes; }
    void add_large(const std::string& path, const std::string& bytes) {
        files_[path] = bytes;
        large_.insert(path);
    }
    void remove(const std::string& path) { files_.erase(path); }

    /// Fault that the server injects into its replies for a file.
    struct Fault {
        int times = 1 << 20;          ///< number of faulty replies
        int status = 0;               ///< status of the reply; 0: the usual one
        std::size_t cut = 0;          ///< number of bytes after which the connection is closed
        bool wrong = false;           ///< true: a byte is flipped
        bool no_ranges = false;       ///< true: range requests get the whole file
        std::size_t slow = 0;         ///< bytes per millisecond
        std::string error_code = {};  ///< header X-Error-Code of the reply
    };
    /// Adds a fault. Several faults of one file apply one after another. The path "api" is the list
    /// of files.
    void break_file(const std::string& path, const Fault& fault) { faults_[path].push_back(fault); }
    /// Makes the server announce a wrong size for a large file.
    void announce(const std::string& path, const std::string& size) { announced_[path] = size; }

    std::string token;            ///< token that requests must have; empty: none
    std::string branch = "main";  ///< the only branch

    std::string url() const { return endpoint_.url(); }
    std::string etag(const std::string& path) const {
        return digest_of(files_.at(path),
                         large_.count(path) > 0 ? DigestKind::sha256 : DigestKind::git_blob);
    }

    struct Seen {
        std::string method, path, range, authorization;
        bool storage;
    };
    std::vector<Seen> seen() {
        const std::lock_guard lock(mutex_);
        return seen_;
    }
    int downloads_of(const std::string& path) {
        int count = 0;
        for (const Seen& request : seen())
            count += request.method == "GET" && request.path == path &&
                     request.storage == (large_.count(path) > 0);
        return count;
    }

  private:
    using Request = httplib::Request;
    using Response = httplib::Response;

    void log(const Request& request, const std::string& path, bool storage) {
        const std::lock_guard lock(mutex_);
        seen_.push_back({request.method, path, request.get_header_value("Range"),
                         request.get_header_value("Authorization"), storage});
    }

    bool refused(const Request& request, Response& response) const {
        if (token.empty() || request.get_header_value("Authorization") == "Bearer " + token)
            return false;
        response.status = 401;
        return true;
    }

    /// Returns the fault for the next reply: the first fault of the file that is not used up.
    Fault next_fault(const std::string& path) {
        const std::lock_guard lock(mutex_);
        for (Fault& fault : faults_[path])
            if (fault.times > 0) {
                --fault.times;
                return fault;
            }
        return {};
    }

    /// Sets the error status of a fault. Returns true if there is one.
    static bool failed(const Fault& fault, Response& response) {
        if (fault.status == 0) return false;
        response.status = fault.status;
        if (!fault.error_code.empty()) response.set_header("X-Error-Code", fault.error_code);
        return true;
    }

    void answer_list(const Request& request, Response& response) {
        log(request, "api", false);
        if (refused(request, response) || failed(next_fault("api"), response)) return;
        if (request.matches[1] != branch && request.matches[1] != commit) {
            response.status = 404;
            response.set_header("X-Error-Code", "RevisionNotFound");
            return;
        }
        nlohmann::json siblings = nlohmann::json::array();
        for (const auto& [path, bytes] : files_)
            siblings.push_back({{"rfilename", path}});
        response.set_content(nlohmann::json{{"sha", commit}, {"siblings", siblings}}.dump(),
                             "application/json");
    }

    void answer_file(const Request& request, Response& response) {
        const std::string path = request.matches[1];
        log(request, path, false);
        if (refused(request, response)) return;
        if (files_.count(path) == 0) {
            response.status = 404;
            return;
        }
        if (large_.count(path) == 0) {
            response.set_header("ETag", "W/\"" + etag(path) + "\"");
            send(path, response);
            return;
        }
        std::string size = std::to_string(files_.at(path).size());
        if (const auto announced = announced_.find(path); announced != announced_.end())
            size = announced->second;
        response.set_header("X-Linked-Etag", "\"" + etag(path) + "\"");
        response.set_header("X-Linked-Size", size);
        response.set_header("ETag", "\"something else\"");
        response.set_redirect(storage_.url() + "/" + path);
    }

    void answer_large_file(const Request& request, Response& response) {
        const std::string path = request.matches[1];
        log(request, path, true);
        send(path, response);
    }

    void send(const std::string& path, Response& response) {
        const Fault fault = next_fault(path);
        if (failed(fault, response)) return;
        std::string bytes = files_.at(path);
        if (fault.wrong) bytes[bytes.size() / 2] ^= 1;
        if (fault.no_ranges) {
            // Without this line httplib would reply 206.
            response.status = 200;
            const std::size_t size = bytes.size();
            response.set_chunked_content_provider(
                "application/octet-stream", [bytes, size](std::size_t offset, auto& sink) {
                    sink.write(bytes.data() + offset, size - offset);
                    sink.done();
                    return true;
                });
            return;
        }
        const std::size_t size = bytes.size();
        auto sent = std::make_shared<std::size_t>(0);
        response.set_content_provider(
            size, "application/octet-stream",
            [bytes, fault, sent](std::size_t offset, std::size_t length, auto& sink) {
                std::size_t count = length;
                if (fault.cut > 0) count = std::min(count, fault.cut - std::min(fault.cut, *sent));
                if (fault.slow > 0) {
                    count = std::min(count, fault.slow);
                    std::this_thread::sleep_for(std::chrono::milliseconds(1));
                }
                if (count == 0) return false;
                *sent += count;
                return sink.write(bytes.data() + offset, count);
            });
    }

    std::map<std::string, std::string> files_;
    std::set<std::string> large_;
    std::map<std::string, std::vector<Fault>> faults_;
    std::map<std::string, std::string> announced_;
    std::mutex mutex_;
    std::vector<Seen> seen_;
    LoopbackServer storage_;
    LoopbackServer endpoint_;
};

/// Returns pseudo-random bytes. If a download shifts or repeats a part of them, their digest
/// differs, which equal bytes would not guarantee.
inline std::string noise_bytes(std::size_t size, std::uint32_t seed) {
    std::string bytes(size, '\0');
    for (char& c : bytes) {
        seed = seed * 1664525 + 1013904223;
        c = static_cast<char>(seed >> 24);
    }
    return bytes;
}

inline std::string file_text(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// Returns the message of the error that `action` throws.
template <typename Failure, typename Action>
std::string error_of(const Action& action) {
    try {
        action();
    } catch (const Failure& failure) {
        return failure.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return "";
}

/// Temporary folder, removed on destruction.
class Folder {
  public:
    Folder() {
        static std::atomic<int> count = 0;
        path = fs::temp_directory_path() / fmt::format("item3d_hub_{}_{}", ::getpid(), count++);
        fs::create_directories(path);
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    fs::path path;
};

}  // namespace item3d::testing
