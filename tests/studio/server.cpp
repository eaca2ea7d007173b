// Tests of the studio over HTTP: access, refusals, and robustness.
#include "item3d/studio/server.h"

#include "item3d/core/error.h"
#include "tests/support/address_space.h"
#include "tests/support/studio.h"

#include <httplib.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <atomic>
#include <set>

namespace item3d::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class StudioHttp : public StudioFolder {
  protected:
    void SetUp() override {
        StudioFolder::SetUp();
        begin();
    }
    void TearDown() override {
        server_.reset();
        studio_.reset();
        StudioFolder::TearDown();
    }
    void begin() {
        studio_ = std::make_unique<Studio>(options_);
        server_ = std::make_unique<StudioServer>(*studio_, "127.0.0.1", 0);
    }
    httplib::Client client(bool with_token = true) const {
        httplib::Client made("127.0.0.1", server_->port());
        made.set_read_timeout(20);
        if (with_token) made.set_default_headers({{"X-Item3d-Token", "0123456789abcdef"}});
        return made;
    }
    std::int64_t open_mug() {
        const auto reply = client().Post("/api/projects?name=mug.glb", "glTF and more",
                                         "application/octet-stream");
        EXPECT_EQ(reply->status, 200) << reply->body;
        return Json::parse(reply->body)["id"];
    }

    std::unique_ptr<Studio> studio_;
    std::unique_ptr<StudioServer> server_;
};

TEST_F(StudioHttp, TooFewOpenFilesAreAnError) {
    const auto begin_with_few = [&] {
        const rlimit few{40, 40};
        ::setrlimit(RLIMIT_NOFILE, &few);
        try {
            StudioServer(*studio_, "127.0.0.1", 0);
        } catch (const ResourceError&) {
            std::_Exit(0);
        }
        std::_Exit(1);
    };
    server_.reset();
    EXPECT_EXIT(begin_with_few(), ::testing::ExitedWithCode(0), "");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(StudioHttp, ThreadsThatCannotBeStartedAreAnError) {
    server_.reset();
    EXPECT_EXIT(exit_after_lack_of_threads([&] { StudioServer(*studio_, "127.0.0.1", 0); }),
                ::testing::ExitedWithCode(0), "");
}
#endif

TEST_F(StudioHttp, OpensByTheTokenOfItsAddress) {
    auto stranger = client(false);
    EXPECT_EQ(stranger.Get("/")->status, 403);
    EXPECT_EQ(stranger.Get("/?token=wrong")->status, 403);
    EXPECT_EQ(stranger.Get("/api/projects")->status, 403);
    EXPECT_EQ(stranger.Post("/api/projects?name=a.glb", "glTF", "")->status, 403);
    const auto page = stranger.Get("/?token=0123456789abcdef");
    EXPECT_EQ(page->status, 200);
    EXPECT_NE(page->body.find("the page"), std::string::npos);
    EXPECT_NE(page->get_header_value("Content-Security-Policy").find("'self' 'sha256-"),
              std::string::npos)
        << "of the import map";
    const std::string cookie = page->get_header_value("Set-Cookie");
    EXPECT_EQ(cookie, "item3d_test=0123456789abcdef; HttpOnly; SameSite=Strict");
    const httplib::Headers has = {{"Cookie", cookie.substr(0, cookie.find(';'))}};
    EXPECT_EQ(stranger.Get("/", has)->status, 200);
    EXPECT_EQ(stranger.Get("/api/projects", has)->body, "[]");
}

TEST_F(StudioHttp, OpensByThePasswordWhereThereIsOne) {
    server_.reset();
    studio_.reset();
    options_.access.password = "long enough";
    begin();
    auto stranger = client(false);
    EXPECT_EQ(stranger.Get("/?token=0123456789abcdef")->status, 403);
    EXPECT_NE(stranger.Get("/")->body.find("type=\"password\""), std::string::npos);
    const auto opened = stranger.Post("/login", httplib::Params{{"password", "long enough"}});
    EXPECT_EQ(opened->status, 303);
    EXPECT_NE(opened->get_header_value("Set-Cookie").find("item3d_test="), std::string::npos);
    EXPECT_EQ(stranger.Post("/login", httplib::Params{{"password", "wrong one"}})->status, 403);
}

TEST_F(StudioHttp, RefusesOtherHostsAndOrigins) {
    auto page = client();
    EXPECT_EQ(page.Get("/api/projects", {{"Host", "evil.example"}})->status, 403);
    EXPECT_EQ(page.Get("/?token=0123456789abcdef", {{"Host", "evil.example"}})->status, 403);
    const auto refused = page.Post("/api/projects?name=mug.glb",
                                   {{"Origin", "http://evil.example"}}, "glTF", "text/plain");
    EXPECT_EQ(refused->status, 403);
    EXPECT_NE(Json::parse(refused->body)["error"].get<std::string>().find("origin"),
              std::string::npos);
    EXPECT_TRUE(studio_->store().projects(10, 0).empty());
}

TEST_F(StudioHttp, ServesFilesOfItsFoldersAlone) {
    write(options_.page / "main.js", std::string(5000, ' '));
    write(options_.page / ".hidden", "");
    write(folder_ / "secret", "");
    auto page = client(false);
    EXPECT_EQ(page.Get("/app/main.js")->body.size(), 5000u);
    const auto again = page.Get("/app/main.js");
    EXPECT_EQ(
        page.Get("/app/main.js", {{"If-None-Match", again->get_header_value("ETag")}})->status,
        304);
    for (const char* path : {"/app/../../secret", "/app/%2e%2e/secret", "/app/..%2fsecret",
                             "/app//etc/passwd", "/app/.hidden", "/app/nothing", "/app/%00"})
        EXPECT_EQ(page.Get(path)->status, 404) << path;
}

TEST_F(StudioHttp, RefusesUploadsThatAreNone) {
    auto page = client();
    const auto upload = [&](const std::string& name, const std::string& bytes) {
        return page.Post("/api/projects?name=" + name, bytes, "application/octet-stream")->status;
    };
    EXPECT_EQ(upload("notes.txt", "glTF"), 400);
    EXPECT_EQ(upload("mug.glb", "no model"), 400);
    EXPECT_EQ(upload("mug.zip", "no archive"), 400);
    EXPECT_EQ(page.Post("/api/projects", "glTF", "")->status, 400) << "without a name";
    EXPECT_TRUE(studio_->store().projects(10, 0).empty());
    EXPECT_TRUE(fs::is_empty(options_.folder / "incoming"));
    EXPECT_TRUE(fs::is_empty(options_.folder / "projects"));
    EXPECT_EQ(upload("..%2F..%2Fevil%01.glb", "glTF"), 200);
    const StudioProject opened = studio_->store().projects(1, 0).front();
    EXPECT_EQ(opened.name, "evil.glb");
    const std::string masks = "/api/projects/" + std::to_string(opened.id) + "/masks?name=a.png";
    for (const std::string& path : {std::string("/api/lights?name=a.png"), masks}) {
        const auto refused = page.Post(path, "no image", "");
        EXPECT_EQ(refused->status, 400);
        EXPECT_EQ(refused->body.find("{\"error\":\"a.png: "), 0u) << refused->body;
    }
    EXPECT_EQ(upload(std::string(300, 'n') + ".glb", "glTF"), 200) << "the name is shortened";
}

TEST_F(StudioHttp, TakesAModelWithItsFiles) {
    auto page = client();
    const auto upload = [&](const std::vector<std::string>& names) {
        httplib::MultipartFormDataItems items;
        for (const std::string& name : names)
            items.push_back({"model", "glTF", name, "application/octet-stream"});
        return page.Post("/api/projects", items);
    };
    const auto reply = upload({"car/maps/a b.png", "car/notes.txt", "car/car.gltf"});
    ASSERT_EQ(reply->status, 200) << reply->body;
    const std::int64_t id = Json::parse(reply->body)["id"];
    EXPECT_EQ(Json::parse(reply->body)["name"], "car.gltf");
    EXPECT_EQ(studio_->project(id).file, "car/car.gltf");
    const fs::path source = options_.folder / "projects" / std::to_string(id) / "source";
    EXPECT_TRUE(fs::exists(source / "car/maps/a b.png")) << "under the name by which it is found";
    EXPECT_FALSE(fs::exists(source / "car/notes.txt"));
    for (const std::vector<std::string>& names : std::vector<std::vector<std::string>>{
             {"a.gltf", "../b.bin"}, {"a.gltf", "/b.bin"}, {"a.png"}, {"a.gltf", "a.gltf"}})
        EXPECT_EQ(upload(names)->status, 400) << names.back();
    EXPECT_EQ(studio_->store().projects(10, 0).size(), 1u);
    EXPECT_TRUE(fs::is_empty(options_.folder / "incoming"));
}

TEST_F(StudioHttp, OpensAModelWithTheFilesBesideIt) {
    const fs::path files = folder_ / "car";
    fs::create_directories(files / "maps");
    write(files / "car.obj", "glTF\nmtllib my car.mtl\n");
    write(files / "my car.mtl", "newmtl a\nmap_Kd -o 0 0 0 maps\\paint.png\n");
    write(files / "maps/paint.png", "1");
    write(files / "other.png", "1");
    const StudioProject opened = studio_->open_again(files / "car.obj");
    const fs::path source = options_.folder / "projects" / std::to_string(opened.id) / "source";
    EXPECT_TRUE(fs::exists(source / "my car.mtl"));
    EXPECT_TRUE(fs::exists(source / "maps/paint.png"));
    EXPECT_FALSE(fs::exists(source / "other.png"));
    EXPECT_EQ(studio_->open_again(files / "car.obj").id, opened.id);
    write(files / "maps/paint.png", "2");
    EXPECT_NE(studio_->open_again(files / "car.obj").id, opened.id) << "its texture has changed";
    fs::create_directories(folder_ / "links");
    fs::create_symlink(files / "car.obj", folder_ / "links/car.obj");
    EXPECT_NO_THROW(studio_->open_again(folder_ / "links/car.obj")) << "no file is beside the link";
}

TEST_F(StudioHttp, RefusesUploadsThatAreTooLong) {
    httplib::Client page = client();
    std::size_t sent = 0;
    page.Post(
        "/api/projects?name=mug.glb", std::size_t{2} << 30,
        [&sent](std::size_t, std::size_t, httplib::DataSink& sink) {
            const std::string piece(1 << 16, 'x');
            sent += piece.size();
            return sink.write(piece.data(), piece.size());
        },
        "application/octet-stream");
    EXPECT_LT(sent, std::size_t{64} << 20) << "of two gigabytes: refused before they come";
    EXPECT_EQ(page.Post("/api/projects/1/edits", std::string(2 << 20, ' '), "")->status, 413);
    EXPECT_EQ(client().Get("/api/projects")->status, 200);
}

TEST_F(StudioHttp, RunsAnEditAndGivesItsFiles) {
    const std::int64_t project = open_mug();
    auto page = client();
    const std::string path = "/api/projects/" + std::to_string(project);
    EXPECT_EQ(page.Get(path + "/model.glb")->body, "glTF and more");
    const auto edited = page.Post(path + "/edits", R"({"from": "a red mug", "to": "a golden mug"})",
                                  "application/json");
    ASSERT_EQ(edited->status, 200) << edited->body;
    const std::int64_t id = Json::parse(edited->body)["id"];
    ASSERT_TRUE(wait_for(*studio_, id, ResultState::done));
    const std::string result = "/api/results/" + std::to_string(id);
    EXPECT_EQ(page.Get(result + "/files/model.glb")->body, "glTF and more");
    const std::string summary = page.Get(result + "/files/edit.json")->body;
    EXPECT_EQ(summary.find(folder_.string()), std::string::npos) << summary;
    EXPECT_EQ(Json::parse(summary)["model"], "projects/1/source");
    for (const char* file : {"../../source/mug.glb", "..%2F..%2Fmodel.json",
                             "checkpoint.safetensors", "/etc/passwd", "live/../edit.json"})
        EXPECT_EQ(page.Get(result + "/files/" + file)->status, 404) << file;
    EXPECT_EQ(page.Patch(result, R"({"favourite": true, "note": "mine"})", "")->status, 200);
    const Json whole = Json::parse(page.Get(path)->body);
    EXPECT_EQ(whole["results"][0]["note"], "mine");
    EXPECT_EQ(whole["results"][0]["state"], "done");
    EXPECT_EQ(page.Delete(result)->status, 200);
    EXPECT_EQ(page.Get(result)->status, 400);
    EXPECT_EQ(page.Post(result + "/resume", "", "")->status, 400);
}

TEST_F(StudioHttp, ShowsRegionsAndMixesLayers) {
    const std::string path = "/api/projects/" + std::to_string(open_mug());
    auto page = client();
    const Json region = Json::parse(
        page.Post(path + "/region", R"({"region": ["material=glaze"], "feather": 2})", "")->body);
    EXPECT_EQ(region["share"], 0.25);
    EXPECT_EQ(region["masks"][0]["material"], 0);
    EXPECT_EQ(page.Get("/" + region["masks"][0]["url"].get<std::string>())->body, "pixels\n");
    EXPECT_EQ(region["command"],
              "item3d region source/mug.glb --region=material=glaze --feather=2 "
              "-o region");
    const Json edited = Json::parse(
        page.Post(path + "/edits", R"({"from": "a red mug", "to": "a golden mug"})", "")->body);
    const Json mixed = Json::parse(
        page.Post(path + "/layers",
                  R"({"layers": [{"result": 1, "strength": 0.5, "channels": ["roughness"]}]})", "")
            ->body);
    EXPECT_EQ(page.Get("/" + mixed["url"].get<std::string>())->body,
              "layers source/mug.glb results/1:0.5:roughness -o mixed.glb\n");
    const Json variants =
        Json::parse(page.Post(path + "/variants", R"({"results": [1]})", "")->body);
    EXPECT_EQ(page.Get("/" + variants["url"].get<std::string>())->body,
              "variants source/mug.glb results/1 -o variants.glb\n");
    for (const char* body : {"{}", R"({"layers": []})", R"({"layers": [{"result": 77}]})",
                             R"({"layers": [{"result": 1, "channels": ["a:b"]}]})"})
        EXPECT_EQ(page.Post(path + "/layers", body, "")->status, 400) << body;
    const Json estimate =
        Json::parse(page.Post(path + "/estimate", "{\"to\": \"a rusty mug\"}", "")->body);
    EXPECT_GT(estimate["seconds"], 1);
}

TEST_F(StudioHttp, AnswersWhatCannotBeUnderstood) {
    open_mug();
    auto page = client();
    for (const char* body : {"{", "[]", "3", "{\"from\": 3}",
                             "{\"from\": \"a\", \"to\": \"b\", "
                             "\"settings\": {\"nothing\": 1}}"}) {
        const auto reply = page.Post("/api/projects/1/edits", body, "application/json");
        EXPECT_EQ(reply->status, 400) << body;
        EXPECT_FALSE(Json::parse(reply->body)["error"].get<std::string>().empty());
    }
    EXPECT_EQ(page.Get("/api/projects/99999999999999999999")->status, 400);
    EXPECT_EQ(page.Post("/nothing", "x", "")->status, 404);
    EXPECT_EQ(page.Patch("/api/results/1", "{\"note\": 3}", "")->status, 400);
}

TEST_F(StudioHttp, StaysUpUnderAThousandRequests) {
    open_mug();
    constexpr int threads = 25, each = 40;
    std::atomic<int> answered = 0;
    std::vector<std::thread> crowd;
    for (int i = 0; i < threads; ++i)
        crowd.emplace_back([&] {
            auto page = client();
            for (int k = 0; k < each; ++k) {
                const auto reply = page.Get("/api/projects/1");
                if (reply && reply->status == 200) ++answered;
            }
        });
    for (std::thread& one : crowd)
        one.join();
    EXPECT_EQ(answered, threads * each);
}

TEST_F(StudioHttp, GivesLightsAsTheyAreChanged) {
    auto page = client();
    const std::string studio = page.Get("/api/lights/studio.hdr?width=64")->body;
    EXPECT_EQ(studio.substr(0, 2), "#?");
    EXPECT_EQ(page.Get("/api/lights/studio.hdr?width=64")->body, studio) << "kept";
    std::set<std::string> seen = {studio};
    for (const char* change : {"sun=120,35", "lit=from%20the%20left", "rotate=90", "tint=%23ff0000",
                               "exposure=1", "tilt=20"}) {
        const auto light = page.Get(std::string("/api/lights/studio.hdr?width=64&") + change);
        EXPECT_EQ(light->status, 200) << change;
        EXPECT_TRUE(seen.insert(light->body).second) << change;
    }
    EXPECT_EQ(page.Get("/api/lights/sky.hdr?width=64&hour=17.5")->status, 200);
    for (const char* wrong : {"studio.hdr?sun=1", "studio.hdr?sun=1,200", "studio.hdr?rotate=nan",
                              "studio.hdr?tint=red", "studio.hdr?lit=nonsense", "sky.hdr?hour=25",
                              "nothing.hdr", "studio.hdr?exposure=1,"})
        EXPECT_EQ(page.Get(std::string("/api/lights/") + wrong)->status, 400) << wrong;
    const auto own = page.Post("/api/lights?name=noon.hdr", studio, "");
    EXPECT_EQ(Json::parse(own->body)["name"], "own_noon");
    EXPECT_EQ(page.Get("/api/lights/own_noon.hdr")->status, 200);
}

TEST_F(StudioHttp, StreamsEventsAndRepeatsThem) {
    const std::int64_t before = studio_->events().last();
    open_mug();
    const auto listen = [&](const httplib::Headers& headers, const std::string& for_text) {
        std::string text;
        client().Get("/api/events", headers, [&](const char* data, std::size_t size) {
            text.append(data, size);
            return text.find(for_text) == std::string::npos;
        });
        return text;
    };
    EXPECT_NE(listen({{"Last-Event-ID", std::to_string(before)}}, "event: project")
                  .find("\"name\":\"mug.glb\""),
              std::string::npos);
    EXPECT_NE(listen({{"Last-Event-ID", "5"}}, "event: reset").find("event: reset"),
              std::string::npos);
    // A page that loses its connection before the first event sends this id.
    const std::string id = "id: " + std::to_string(studio_->events().last()) + "\n\n";
    EXPECT_NE(listen({}, "\n\n").find(id), std::string::npos);
}

TEST_F(StudioHttp, IsTheOnlyOneInItsFolder) {
    EXPECT_THROW(Studio{options_}, InputError);
    EXPECT_THROW(StudioServer(*studio_, "127.0.0.1", server_->port()), ResourceError);
}

}  // namespace
}  // namespace item3d::testing
