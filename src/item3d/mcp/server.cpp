#include "item3d/mcp/server.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/version.h"
#include "item3d/mcp/json_rpc.h"
#include "item3d/mcp/running_tool.h"
#include "item3d/mcp/tool_list.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <deque>
#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Supported versions, newest first.
constexpr std::array<std::string_view, 4> protocol_versions{"2025-11-25", "2025-06-18",
                                                            "2025-03-26", "2024-11-05"};
constexpr std::size_t longest_line = 16 << 20;
constexpr int poll_milliseconds = 100;

void send(const json& message) {
    const std::string line = message.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
    if (std::fwrite(line.data(), 1, line.size(), stdout) != line.size() || std::fflush(stdout) != 0)
        throw ResourceError("stdout: cannot be written");
}

/// Reader of the lines of standard input.
class LineReader {
  public:
    /// Waits for input. Returns false at its end.
    bool wait(int milliseconds) {
        pollfd input{STDIN_FILENO, POLLIN, 0};
        if (::poll(&input, 1, milliseconds) <= 0) return true;
        std::array<char, 65536> buffer;
        const ssize_t count = ::read(STDIN_FILENO, buffer.data(), buffer.size());
        if (count < 0) return errno == EINTR || errno == EAGAIN;
        text_.append(buffer.data(), static_cast<std::size_t>(count));
        return count > 0;
    }
    std::optional<std::string> next() {
        const std::size_t end = text_.find('\n');
        if (end == std::string::npos) {
            if (text_.size() > longest_line)
                throw InputError("stdin", "a line is longer than 16 MB");
            return std::nullopt;
        }
        std::string line = text_.substr(0, end);
        text_.erase(0, end + 1);
        return line;
    }

  private:
    std::string text_;
};

/// A tool call that waits or runs.
struct Call {
    json id;
    json progress_token;  ///< null if no progress is requested
    ToolCommand command;
    bool is_cancelled = false;
};

class Server {
  public:
    Server(const AllowedFolders& folders, const McpOptions& options)
        : folders_(folders), options_(options) {}

    void run() {
        LineReader lines;
        bool goes_on = true;
        while (goes_on && !interrupted()) {
            goes_on = lines.wait(poll_milliseconds);
            while (const auto line = lines.next())
                if (!line->empty()) answer(*line);
            follow_calls();
        }
        end_running();
    }

  private:
    void answer(const std::string& line) {
        const RpcLine read = read_rpc_line(line);
        if (read.error) send(*read.error);
        if (!read.request) return;
        const RpcRequest& request = *read.request;
        if (!request.wants_answer()) {
            if (request.method == "notifications/cancelled")
                cancel(request.parameters.value("requestId", json()));
        } else if (request.method == "initialize") {
            send(rpc_result(request.id, initialize(request.parameters)));
        } else if (request.method == "ping") {
            send(rpc_result(request.id, json::object()));
        } else if (request.method == "tools/list") {
            json list = json::array();
            for (const Tool& tool : tools())
                list.push_back(description_of(tool));
            send(rpc_result(request.id, {{"tools", list}}));
        } else if (request.method == "tools/call") {
            call(request);
        } else {
            send(rpc_error(request.id, RpcError::unknown_method,
                           "unknown method " + request.method));
        }
    }

    json initialize(const json& parameters) const {
        const std::string wanted =
            parameters.contains("protocolVersion") && parameters["protocolVersion"].is_string()
                ? parameters["protocolVersion"].get<std::string>()
                : "";
        const auto known = std::find(protocol_versions.begin(), protocol_versions.end(), wanted);
        std::string list;
        for (const fs::path& folder : folders_.all())
            list += (list.empty() ? "" : ", ") + folder.string();
        return {
            {"protocolVersion",
             known == protocol_versions.end() ? protocol_versions.front() : *known},
            {"capabilities", {{"tools", json::object()}}},
            {"serverInfo", {{"name", "item3d"}, {"title", "item3d"}, {"version", version()}}},
            {"instructions", "Edits the look of textured 3D models. Files are read from " + list +
                                 "; results are new folders in " + folders_.output().string() +
                                 ". Look at a model with describe or render, edit it, then look at "
                                 "the images of the result."}};
    }

    void call(const RpcRequest& request) {
        const json name = request.parameters.value("name", json());
        const auto tool = std::find_if(tools().begin(), tools().end(),
                                       [&](const Tool& each) { return name == each.name; });
        const json given = request.parameters.value("arguments", json::object());
        if (tool == tools().end() || !given.is_object()) {
            send(rpc_error(request.id, RpcError::invalid_parameters,
                           tool == tools().end() ? "unknown tool " + name.dump()
                                                 : "arguments must be an object"));
            return;
        }
        const json meta = request.parameters.value("_meta", json::object());
        const json token = meta.is_object() ? meta.value("progressToken", json()) : json();
        try {
            calls_.push_back(
                {request.id, token, command_of(*tool, given, folders_, options_.settings)});
        } catch (const Error& error) {
            send(rpc_result(request.id, failed_call(error.what())));
        }
    }

    /// Cancels a call without a reply. A waiting call is removed, and a running call is asked to
    /// end.
    void cancel(const json& id) {
        for (auto call = calls_.begin(); call != calls_.end(); ++call) {
            if (call->id != id) continue;
            if (call == calls_.begin() && running_) {
                call->is_cancelled = true;
                running_->cancel();
            } else {
                calls_.erase(call);
            }
            return;
        }
    }

    /// Starts the first call if it does not run yet. Sends its progress, and its result once it has
    /// ended.
    void follow_calls() {
        if (calls_.empty()) return;
        const Call& call = calls_.front();
        try {
            if (!running_)
                running_ = std::make_unique<RunningTool>(call.command, options_.launcher,
                                                         options_.scratch);
            if (const auto progress = running_->progress();
                progress && !call.progress_token.is_null() && !call.is_cancelled)
                send(rpc_notification("notifications/progress",
                                      {{"progressToken", call.progress_token},
                                       {"progress", progress->steps},
                                       {"message", progress->message}}));
            const auto result = running_->result();
            if (!result) return;
            if (!call.is_cancelled) send(rpc_result(call.id, *result));
        } catch (const InputError& error) {
            send(rpc_result(call.id, failed_call(error.what())));
        }
        running_.reset();
        calls_.pop_front();
    }

    void end_running() {
        if (!running_) return;
        constexpr auto longest = std::chrono::seconds(20);
        const auto last = std::chrono::steady_clock::now() + longest;
        running_->cancel();
        while (!running_->result() && std::chrono::steady_clock::now() < last)
            std::this_thread::sleep_for(std::chrono::milliseconds(poll_milliseconds));
        running_.reset();
    }

    const AllowedFolders& folders_;
    const McpOptions& options_;
    std::deque<Call> calls_;
    std::unique_ptr<RunningTool> running_;  ///< the tool of the first call
};

}  // namespace

void serve_mcp(const AllowedFolders& folders, const McpOptions& options) {
    Server(folders, options).run();
}

}  // namespace item3d
