// Fixture of the command-line tests, which runs the program in a temporary folder.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace item3d::testing {

namespace fs = std::filesystem;

struct Result {
    int code = -1;
    std::string out;
    std::string error;
};

inline std::string read_file(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

class Program : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("item3d_cli_" + std::to_string(::getpid()));
        fs::create_directories(folder_);
        // With a fixed date, edits that are compared write the same bytes.
        setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
        cube_ = folder_ / "cube.obj";
        std::ofstream light(folder_ / "small.hdr", std::ios::binary);
        light << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n";
        for (int texel = 0; texel < 32; ++texel)
            light << (texel % 8 < 3 ? "\xff\xf0\xe0\x82" : "\x50\x60\x70\x80");
        std::ofstream(cube_) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    }
    void TearDown() override { fs::remove_all(folder_); }

    /// Runs `item3d ARGUMENTS`. After a minute the program is ended, and the exit code is 124.
    Result run(const std::string& arguments, const std::string& before = "") const {
        const fs::path out = folder_ / "stdout";
        const fs::path error = folder_ / "stderr";
        const std::string command = before + "timeout 60 '" ITEM3D_PROGRAM "' " + arguments +
                                    " >'" + out.string() + "' 2>'" + error.string() + "'";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(out), read_file(error)};
    }

    /// Expects one line of error on stderr that contains `subject`.
    void expect_error(const std::string& arguments, int code, const std::string& subject,
                      const std::string& before = "") const {
        const Result result = run(arguments, before);
        EXPECT_EQ(result.code, code) << arguments << "\n" << result.error;
        const std::size_t start = result.error.find("item3d: error: ");
        ASSERT_NE(start, std::string::npos) << arguments << "\n" << result.error;
        const std::string line = result.error.substr(start);
        EXPECT_NE(line.find(subject), std::string::npos) << line;
        EXPECT_EQ(line.find('\n'), line.size() - 1) << "more than one line: " << line;
    }

    /// Returns a small light for tests in which the light does not matter. The full-size preset
    /// takes half a second to load.
    std::string small_light() const { return " --light " + quoted(folder_ / "small.hdr") + " "; }
    std::string quoted(const fs::path& path) const { return "'" + path.string() + "'"; }

    fs::path folder_;
    fs::path cube_;
};

/// Fixture of item3d edit with a prior of random weights, small enough for a test.
class EditProgram : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        fs::copy(ITEM3D_TEST_DATA "/models/pipeline_sd", prior(), fs::copy_options::recursive);
        std::ofstream(prior() + "/prior.json")
            << R"({"defaults": {"fit_steps": 20, "light_augment": "off"}})";
    }
    std::string prior() const { return (folder_ / "pipeline_sd").string(); }
    std::string edit(const std::string& rest) const { return edit(rest, prior()); }
    std::string edit(const std::string& rest, const std::string& prior_folder) const {
        return "edit " + quoted(cube_) + " --prior '" + prior_folder +
               "' --resolution 32 --batch 1 --iterations 3 --texture-size 64 --image-size 32 " +
               rest;
    }
    std::string to(const std::string& name) const {
        return " --from 'a red cube' --to 'a blue cube' -o " + quoted(folder_ / name);
    }
    /// Returns a copy of the prior, which a test may damage.
    fs::path copy_of_prior(const std::string& name) const {
        fs::copy(prior(), folder_ / name, fs::copy_options::recursive);
        return folder_ / name;
    }
};

}  // namespace item3d::testing
