#include "item3d/mcp/json_rpc.h"

#include "item3d/core/parse_json.h"

namespace item3d {

using nlohmann::json;

RpcLine read_rpc_line(const std::string& line) {
    const json message = parse_json(line);
    if (message.is_discarded())
        return {std::nullopt, rpc_error(nullptr, RpcError::parse, "the line is not JSON")};
    const auto invalid = [&](const std::string& what) {
        const bool has_id = message.is_object() && message.contains("id");
        return RpcLine{std::nullopt,
                       rpc_error(has_id ? message["id"] : json(), RpcError::invalid_request, what)};
    };
    if (!message.is_object()) return invalid("expected one object; batches are not supported");
    if (message.contains("result") || message.contains("error")) return {};
    const auto method = message.find("method");
    if (method == message.end() || !method->is_string()) return invalid("has no method");
    RpcRequest request;
    request.method = method->get<std::string>();
    if (const auto id = message.find("id"); id != message.end()) {
        if (!id->is_string() && !id->is_number_integer())
            return invalid("id must be a string or a whole number");
        request.id = *id;
    }
    if (const auto parameters = message.find("params"); parameters != message.end()) {
        if (!parameters->is_object()) return invalid("params must be an object");
        request.parameters = *parameters;
    }
    return {request, std::nullopt};
}

json rpc_result(const json& id, json result) {
    return {{"jsonrpc", "2.0"}, {"id", id}, {"result", std::move(result)}};
}

json rpc_error(const json& id, RpcError code, const std::string& message) {
    return {{"jsonrpc", "2.0"},
            {"id", id},
            {"error", {{"code", static_cast<int>(code)}, {"message", message}}}};
}

json rpc_notification(const std::string& method, json parameters) {
    return {{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(parameters)}};
}

}  // namespace item3d
