// Tests of the commands that the page's requests become, and of refused arguments.
#include "item3d/studio/commands.h"

#include "item3d/core/error.h"
#include "tests/support/studio.h"

#include <algorithm>

namespace item3d::testing {
namespace {

using Json = nlohmann::json;

class StudioRequests : public StudioFolder {
  protected:
    void SetUp() override {
        StudioFolder::SetUp();
        folders_ = std::make_unique<StudioFolders>(options_.folder, options_.programs);
        commands_ = std::make_unique<StudioCommands>(
            *folders_, Json::parse(read(options_.page / "settings.json")));
        project_.id = 1;
        project_.file = "mug.glb";
        std::filesystem::create_directories(folders_->project(1) / "masks");
        write(folders_->project(1) / "masks/paint.png", "");
    }
    std::vector<std::string> arguments(Json request, const std::string& kind = "edit") const {
        StudioResult result;
        result.id = 3;
        result.kind = kind;
        result.request = std::move(request);
        return commands_->make(project_, result, nullptr).arguments;
    }
    std::string refusal(Json more) const {
        Json request = {{"from", "a"}, {"to", "b"}};
        request.update(more);
        try {
            arguments(request);
            return "";
        } catch (const InputError& error) {
            return error.what();
        }
    }
    static bool has(const std::vector<std::string>& arguments, const std::string& one) {
        return std::find(arguments.begin(), arguments.end(), one) != arguments.end();
    }

    std::unique_ptr<StudioFolders> folders_;
    std::unique_ptr<StudioCommands> commands_;
    StudioProject project_;
};

TEST_F(StudioRequests, BecomeOptions) {
    const auto made = arguments({{"from", "--json"},
                                 {"to", "it's $HOME"},
                                 {"settings", {{"seed", 3}, {"keep", {"normal", "occlusion"}}}},
                                 {"region", {"material=glaze", "mask=masks/paint.png@glaze"}},
                                 {"feather", 2.5}});
    EXPECT_EQ(made.front(), "edit");
    EXPECT_EQ(made[1], "source/mug.glb");
    for (const char* one : {"--from=--json", "--to=it's $HOME", "--seed=3",
                            "--keep=normal,occlusion", "--region=material=glaze",
                            "--region=mask=masks/paint.png@glaze", "--feather=2.5", "results/3"})
        EXPECT_TRUE(has(made, one)) << one;
    StudioCommand command{"edit", {"edit", "my mug.glb", "--to=it's"}};
    EXPECT_EQ(shown_command(command), R"(item3d edit 'my mug.glb' '--to=it'\''s')");
}

TEST_F(StudioRequests, NameNothingOfThisMachine) {
    EXPECT_NE(refusal({{"settings", {{"lora", {"/etc/passwd"}}}}}), "");
    EXPECT_NE(refusal({{"settings", {{"light", "/etc/passwd"}}}}), "");
    EXPECT_NE(refusal({{"settings", {{"light", "../../light.hdr"}}}}), "");
    EXPECT_NE(refusal({{"settings", {{"prior", "/tmp/prior"}}}}), "");
    EXPECT_NE(refusal({{"settings", {{"prior", "a/../../b"}}}}), "");
    EXPECT_NE(refusal({{"region", {"mask=../../source/mug.glb"}}}), "");
    EXPECT_NE(refusal({{"region", {"view=/etc/passwd"}}}), "");
    EXPECT_NE(refusal({{"settings", {{"light", Json::array()}}}}), "");
    EXPECT_EQ(refusal({{"settings", {{"light", "noon"}, {"prior", "org/name"}}}}), "");
}

TEST_F(StudioRequests, AreRefusedWhereTheyCannotBeUnderstood) {
    EXPECT_NE(refusal({{"settings", {{"nothing", 1}}}}).find("unknown setting"), std::string::npos);
    EXPECT_NE(refusal({{"settings", {{"seed", Json::object()}}}}), "");
    EXPECT_NE(refusal({{"settings", 3}}), "");
    const auto refusal_of = [&](const char* name, const Json& value) {
        return refusal({{"settings", {{name, value}}}});
    };
    for (const Json& invalid : {Json(-1), Json(1.5), Json("ten"), Json("")})
        EXPECT_EQ(refusal_of("iterations", invalid), "iterations: must be 0 or more") << invalid;
    EXPECT_EQ(refusal_of("iterations", 10), "");
    EXPECT_EQ(refusal_of("cfg", 1e300), "cfg: is invalid");
    EXPECT_EQ(refusal_of("cfg", -7.5), "");
    EXPECT_EQ(refusal_of("detail", "magic"), "detail: is invalid");
    EXPECT_EQ(refusal_of("detail", "off"), "");
    EXPECT_EQ(refusal_of("seed", 18446744073709551615u), "");
    EXPECT_NE(refusal({{"to", ""}}).find("missing"), std::string::npos);
    EXPECT_THROW(arguments({}, "relight"), InputError);
    EXPECT_THROW(arguments({}, "boil"), InputError);
    EXPECT_THROW(arguments({{"light", "result-1"}}, "relight"), InputError) << "it has no light";
    const auto lit = folders_->result(project_.id, 2);
    std::filesystem::create_directories(lit);
    write(lit / "light.hdr", "light");
    EXPECT_TRUE(has(arguments({{"light", "result-2"}}, "relight"), "--light=results/2/light.hdr"));
    EXPECT_TRUE(has(arguments({{"hour", 17.5}}, "relight"), "--sky=17.5"));
    EXPECT_TRUE(has(arguments({{"sun", {90, 20}}}, "relight"), "--sun=90,20"));
}

TEST_F(StudioRequests, GiveSafeNames) {
    EXPECT_EQ(shown_name("../../etc/pass\x01wd", "model"), "passwd");
    EXPECT_EQ(shown_name("a/..", "model"), "model");
    EXPECT_EQ(shown_name("C:\\mugs\\red mug.glb", "model"), "red mug.glb");
    EXPECT_EQ(stored_name("../r\xc3\xa9 d;$(x).GLB"), "r___d___x_.glb");
    EXPECT_EQ(stored_name(""), "file");
    EXPECT_LE(shown_name(std::string(5000, 'x'), "").size(), 120u);
    const std::string inside = (options_.folder / "projects/1").string();
    EXPECT_EQ(folders_->without_paths("in " + inside + ": no"), "in projects/1: no");
}

}  // namespace
}  // namespace item3d::testing
