#include "item3d/mcp/json_rpc.h"
#include "item3d/mcp/tool_command.h"
#include "item3d/mcp/tool_list.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<0>(data, size, maximum, seed))

/// Parses a line that an agent sent: its request and, if this calls a tool, the command line of
/// that tool.
ITEM3D_FUZZ_TARGET(agent_line, data, size) {
    using namespace item3d;
    static const auto folder = fuzz::as_file("mug.glb", "glTF").parent_path();
    static const AllowedFolders folders({folder}, folder);
    static const auto settings = nlohmann::json::parse(
        R"([{"name": "seed", "flag": "--seed"}, {"name": "lora", "flag": "--lora", "path": true}])");
    return fuzz::read_or_refuse([&] {
        const RpcLine line = read_rpc_line(fuzz::as_text(data, size));
        if (line.error) line.error->dump();
        if (!line.request) return;
        const auto& asked = line.request->parameters;
        rpc_result(line.request->id, asked).dump();
        const auto name = asked.value("name", nlohmann::json());
        const auto given = asked.value("arguments", nlohmann::json::object());
        for (const Tool& tool : tools()) {
            if (name != tool.name || !given.is_object()) continue;
            const ToolCommand command = command_of(tool, given, folders, settings);
            std::error_code ignored;
            if (command.result != folder) std::filesystem::remove_all(command.result, ignored);
        }
    });
}
