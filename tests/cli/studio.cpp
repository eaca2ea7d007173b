// Tests of item3d studio as a program: output, exit and refusals.
#include "tests/support/program.h"

#include <httplib.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdlib>
#include <thread>

namespace item3d::testing {
namespace {

using StudioProgram = Program;

TEST_F(StudioProgram, ServesUntilItIsInterrupted) {
    const fs::path out = folder_ / "address", error = folder_ / "notes";
    const std::string data = quoted(folder_ / "data");
    const std::string command = "( '" ITEM3D_PROGRAM "' studio " + quoted(cube_) +
                                " --no-browser --folder " + data + " >" + quoted(out) + " 2>" +
                                quoted(error) + " & echo $! >" + quoted(folder_ / "id") +
                                "; wait $!; echo $? >" + quoted(folder_ / "status") + " ) &";
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_EQ(std::system(command.c_str()), 0);
    for (int i = 0; i < 2000 && read_file(out).find('\n') == std::string::npos; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    RecordProperty("seconds_to_address", std::to_string(took.count()));

    const std::string address = read_file(out);
    ASSERT_EQ(address.find("http://127.0.0.1:"), 0u) << address << read_file(error);
    const std::size_t query = address.find("/?token=");
    ASSERT_NE(query, std::string::npos) << address;
    EXPECT_NE(address.find("&project=1\n"), std::string::npos) << address;
    const int port = std::atoi(address.c_str() + std::string("http://127.0.0.1:").size());
    const std::string token = address.substr(query + 8, address.find('&') - query - 8);
    httplib::Client page("127.0.0.1", port);
    EXPECT_EQ(page.Get("/?token=" + token)->status, 200);
    page.set_default_headers({{"X-Item3d-Token", token}});
    const auto project = nlohmann::json::parse(page.Get("/api/projects/1")->body);
    EXPECT_EQ(project["model"]["triangles"], 2);
    EXPECT_EQ(page.Get("/api/projects/1/model.glb")->body.substr(0, 4), "glTF");
    EXPECT_GT(nlohmann::json::parse(page.Get("/api/about")->body)["settings"].size(), 20u);

    std::system(("kill -INT $(cat " + quoted(folder_ / "id") + ")").c_str());
    // The database closes after the last line is printed, so the end of the process is awaited.
    for (int i = 0; i < 2000 && read_file(folder_ / "status").find('\n') == std::string::npos; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(read_file(folder_ / "status"), "0\n");
    EXPECT_NE(read_file(error).find("ended; running jobs were paused"), std::string::npos);
}

TEST_F(StudioProgram, RefusesWhatCannotBeServed) {
    const std::string data = " --no-browser --folder " + quoted(folder_ / "data");
    expect_error("studio --host 0.0.0.0" + data, 2, "--password-file FILE is required");
    expect_error("studio --host 0.0.0.0 --password-file " + quoted(folder_ / "none") + data, 3,
                 "no such file");
    std::ofstream(folder_ / "short") << "1234\n";
    expect_error("studio --host 0.0.0.0 --password-file " + quoted(folder_ / "short") + data, 3,
                 "has 4 characters; use 8 or more");
    expect_error("studio " + quoted(folder_ / "none.glb") + data, 3, "no such file");
    std::ofstream(folder_ / "broken.glb") << "no model";
    expect_error("studio " + quoted(folder_ / "broken.glb") + data, 3, "binary glTF");
    std::ofstream(folder_ / "model.blend") << "no model";
    expect_error("studio " + quoted(folder_ / "model.blend") + data, 3,
                 "has an unsupported format");
}

}  // namespace
}  // namespace item3d::testing
