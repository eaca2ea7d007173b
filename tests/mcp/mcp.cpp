// Tests of messages of the Model Context Protocol, and of the command lines that tool calls become.
#include "item3d/core/error.h"
#include "item3d/mcp/json_rpc.h"
#include "item3d/mcp/tool_command.h"
#include "item3d/mcp/tool_list.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

int code_of(const RpcLine& line) {
    return line.error ? line.error->at("error").at("code").get<int>() : 0;
}

TEST(JsonRpc, ReadsRequestsAndNotifications) {
    const RpcLine line =
        read_rpc_line(R"({"jsonrpc":"2.0","id":"a","method":"ping","params":{"x":1}})");
    ASSERT_TRUE(line.request);
    EXPECT_EQ(line.request->method, "ping");
    EXPECT_EQ(line.request->parameters["x"], 1);
    EXPECT_TRUE(line.request->wants_answer());
    EXPECT_FALSE(read_rpc_line(R"({"jsonrpc":"2.0","method":"n"})").request->wants_answer());
    const RpcLine answer = read_rpc_line(R"({"jsonrpc":"2.0","id":1,"result":{}})");
    EXPECT_FALSE(answer.request || answer.error);
}

TEST(JsonRpc, AnswersWhatIsNoRequest) {
    EXPECT_EQ(code_of(read_rpc_line("{\"id\": 1,")), -32700);
    EXPECT_EQ(code_of(read_rpc_line("[]")), -32600);
    EXPECT_EQ(code_of(read_rpc_line(R"({"id":1})")), -32600);
    EXPECT_EQ(code_of(read_rpc_line(R"({"id":{},"method":"ping"})")), -32600);
    EXPECT_EQ(code_of(read_rpc_line(R"({"id":1,"method":"ping","params":[1]})")), -32600);
}

class McpTools : public testing::Test {
  protected:
    void SetUp() override {
        root_ = fs::canonical(fs::temp_directory_path()) /
                ("item3d_mcp_test_" + std::to_string(::getpid()));
        for (const char* folder : {"models", "models2", "out"})
            fs::create_directories(root_ / folder);
        for (const char* file : {"models/mug.glb", "models/mask.png", "models2/secret.glb"})
            std::ofstream(root_ / file) << "x";
        fs::create_symlink(root_ / "models2/secret.glb", root_ / "models/link.glb");
        folders_.emplace(std::vector<fs::path>{root_ / "models"}, root_ / "out");
    }
    void TearDown() override { fs::remove_all(root_); }

    ToolCommand command(const std::string& name, const json& given) const {
        const auto tool = std::find_if(tools().begin(), tools().end(),
                                       [&](const Tool& each) { return each.name == name; });
        return command_of(*tool, given, *folders_, settings_);
    }
    std::string refusal(const std::string& name, const json& given) const {
        try {
            command(name, given);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }

    fs::path root_;
    std::optional<AllowedFolders> folders_;
    const json settings_ = {{{"name", "guidance"}, {"flag", "--guidance"}},
                            {{"name", "lora"}, {"flag", "--lora"}, {"path", true}},
                            {{"name", "controlnet"}, {"flag", "--controlnet"}, {"path", true}}};
};

TEST_F(McpTools, BecomeCommandLines) {
    const ToolCommand edit = command("edit", {{"model", "mug.glb"},
                                              {"from", "a red mug"},
                                              {"to", "--resume"},
                                              {"region", {"words=the handle", "mask=mask.png@a"}},
                                              {"iterations", 12},
                                              {"settings", {{"guidance", "dds"}}}});
    const std::string models = (root_ / "models").string();
    EXPECT_EQ(edit.arguments,
              (std::vector<std::string>{
                  "edit", "--from=a red mug", "--to=--resume", "--region=words=the handle",
                  "--region=mask=" + models + "/mask.png@a", "--iterations=12", "--guidance=dds",
                  "--output=" + (root_ / "out/edit-mug-1").string(), "--", models + "/mug.glb"}));
    EXPECT_TRUE(fs::is_directory(root_ / "out/edit-mug-1"));
    const json lora = {{"lora", {"mask.png:0.5"}}};
    EXPECT_EQ(
        command("edit", {{"model", "mug.glb"}, {"from", "a"}, {"to", "b"}, {"settings", lora}})
            .arguments[3],
        "--lora=" + models + "/mask.png:0.5");
    const ToolCommand variants =
        command("variants", {{"model", "mug.glb"}, {"edits", {"edit-mug-1"}}});
    EXPECT_EQ(variants.arguments.back(), (root_ / "out/edit-mug-1").string());
    EXPECT_TRUE(
        command("score", {{"before", "mug.glb"}, {"after", "mug.glb"}, {"from", "a"}, {"to", "b"}})
            .result.empty());
}

TEST_F(McpTools, ReadNothingOutsideTheirFolders) {
    const std::string outside = "outside the folders";
    for (const char* model :
         {"../models2/secret.glb", "link.glb", "/etc/passwd", "mug.glb/../../x"})
        EXPECT_NE(refusal("render", {{"model", model}}), "") << model;
    EXPECT_NE(refusal("render", {{"model", "link.glb"}}).find(outside), std::string::npos);
    EXPECT_NE(refusal("render", {{"model", "mug.glb"}, {"light", "/etc/passwd"}}).find(outside),
              std::string::npos);
    EXPECT_NE(
        refusal("region", {{"model", "mug.glb"}, {"region", {"mask=/etc/passwd"}}}).find(outside),
        std::string::npos);
    const json settings = {{"controlnet", "/etc"}};
    EXPECT_NE(
        refusal("edit", {{"model", "mug.glb"}, {"from", "a"}, {"to", "b"}, {"settings", settings}})
            .find(outside),
        std::string::npos);
    EXPECT_TRUE(fs::is_empty(root_ / "out")) << "a refused call leaves no folder";
}

TEST_F(McpTools, RefuseWhatTheyDoNotKnow) {
    EXPECT_NE(refusal("render", {{"views", 2}}).find("model: is missing"), std::string::npos);
    EXPECT_NE(refusal("render", {{"model", "mug.glb"}, {"views", "two"}}).find("expected integer"),
              std::string::npos);
    EXPECT_NE(refusal("render", {{"model", "mug.glb"}, {"output", "/tmp"}}).find("not an argument"),
              std::string::npos);
    EXPECT_NE(refusal("render", {{"model", "none.glb"}}).find("does not exist"), std::string::npos);
}

TEST(McpToolList, HasASchemaForEach) {
    for (const Tool& tool : tools()) {
        const json description = description_of(tool);
        EXPECT_EQ(description["inputSchema"]["type"], "object");
        for (const ToolArgument& argument : tool.arguments)
            EXPECT_TRUE(description["inputSchema"]["properties"].contains(argument.name));
    }
}

}  // namespace
}  // namespace item3d
