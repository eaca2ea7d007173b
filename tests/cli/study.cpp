// Tests of the program from a comparison's folder to a study's table.
#include "item3d/io/save.h"
#include "tests/support/program.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace item3d::testing {
namespace {

class StudyProgram : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        std::string table = "case,model,from,to,method,prior,seed,clip_global,folder\n";
        for (const std::string method : {"plain", "texture"}) {
            const fs::path run = comparison() / "runs" / method;
            fs::create_directories(run);
            for (const char* file : {"before.png", "after.png"})
                save_image(run / file, Image(8, 8, 3, 0.5f));
            std::ofstream(run / "turntable.webp", std::ios::binary)
                << std::string("RIFF\x04\0\0\0WEBP", 12);
            table +=
                "mug,mug.glb,a mug,a blue mug," + method + ",embedded,0,0.5,runs/" + method + "\n";
        }
        std::ofstream(comparison() / "table.csv") << table;
    }
    fs::path comparison() const { return folder_ / "comparison"; }
    fs::path study() const { return folder_ / "study"; }

    /// Runs the study's server until it has printed the links, runs `meanwhile`, and interrupts the
    /// server.
    Result serve(const std::string& meanwhile = "true") const {
        const fs::path out = folder_ / "links", error = folder_ / "notes";
        const std::string command =
            "'" ITEM3D_PROGRAM "' study serve " + quoted(study()) + " --participants 3 --port 0 >" +
            quoted(out) + " 2>" + quoted(error) +
            " & server=$!; for i in $(seq 600); do grep -q serving " + quoted(error) +
            " && break; sleep 0.05; done; " + meanwhile + "; kill -INT $server; wait $server";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(out), read_file(error)};
    }
};

TEST_F(StudyProgram, MakesServesAndAnalyzes) {
    const Result made = run("study make " + quoted(comparison()) + " --json -o " + quoted(study()));
    EXPECT_EQ(made.code, 0) << made.error;
    EXPECT_EQ(nlohmann::json::parse(made.out)["pages"], 6);

    const std::string second = "'" ITEM3D_PROGRAM "' study serve " + quoted(study()) +
                               " --port 0 >/dev/null 2>" + quoted(folder_ / "second") +
                               "; echo $? >" + quoted(folder_ / "code");
    const Result served = serve(second);
    EXPECT_EQ(served.code, 0) << "Ctrl-C is the end and no error: " << served.error;
    EXPECT_EQ(std::count(served.out.begin(), served.out.end(), '\n'), 3);
    EXPECT_EQ(served.out.find("1\thttp://127.0.0.1:"), 0u) << served.out;
    EXPECT_EQ(read_file(folder_ / "code"), "3\n");
    EXPECT_NE(read_file(folder_ / "second").find("is already served"), std::string::npos);

    const fs::path database = study() / "answers.sqlite";
    fs::resize_file(database, fs::file_size(database) / 2);
    const std::string cut = read_file(database);
    expect_error("study serve " + quoted(study()), 3, "is damaged");
    EXPECT_EQ(read_file(database), cut);
}

TEST_F(StudyProgram, OfOneMethodIsRefused) {
    std::ofstream(comparison() / "table.csv")
        << "case,model,from,to,method,prior,seed,folder\nmug,m,a,b,plain,p,0,runs/plain\n";
    expect_error("study make " + quoted(comparison()) + " -o " + quoted(study()), 3, "one method");
    EXPECT_FALSE(fs::exists(study()));
}

}  // namespace
}  // namespace item3d::testing
