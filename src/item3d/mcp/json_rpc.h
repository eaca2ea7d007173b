// Messages of JSON-RPC 2.0 as the Model Context Protocol sends them on standard streams: one JSON
// object on a line.
#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>

namespace item3d {

enum class RpcError {
    parse = -32700,
    invalid_request = -32600,
    unknown_method = -32601,
    invalid_parameters = -32602,
};

struct RpcRequest {
    nlohmann::json id;  ///< a string or number; null: a notification, which gets no answer
    std::string method;
    nlohmann::json parameters = nlohmann::json::object();
    bool wants_answer() const { return !id.is_null(); }
};

/// A request, or the error to answer with. Neither: the line was an answer, and nothing was asked.
struct RpcLine {
    std::optional<RpcRequest> request;
    std::optional<nlohmann::json> error;
};
RpcLine read_rpc_line(const std::string& line);

nlohmann::json rpc_result(const nlohmann::json& id, nlohmann::json result);
nlohmann::json rpc_error(const nlohmann::json& id, RpcError code, const std::string& message);
nlohmann::json rpc_notification(const std::string& method, nlohmann::json parameters);

}  // namespace item3d
