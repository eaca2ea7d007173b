// Messages of JSON-RPC 2.0 on standard streams, as in the Model Context Protocol: one JSON object
// per line.
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
    nlohmann::json id;  ///< string or number; null for a notification, which gets no reply
    std::string method;
    nlohmann::json parameters = nlohmann::json::object();
    bool wants_answer() const { return !id.is_null(); }
};

/// A parsed line: a request, or the error to send as the reply. Both members are empty if the line
/// is itself a reply.
struct RpcLine {
    std::optional<RpcRequest> request;
    std::optional<nlohmann::json> error;
};
RpcLine read_rpc_line(const std::string& line);

nlohmann::json rpc_result(const nlohmann::json& id, nlohmann::json result);
nlohmann::json rpc_error(const nlohmann::json& id, RpcError code, const std::string& message);
nlohmann::json rpc_notification(const std::string& method, nlohmann::json parameters);

}  // namespace item3d
