// Tests of item3d batch: jobs of a file with several workers.
#include "tests/support/program.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace item3d::testing {
namespace {

using nlohmann::json;

class BatchProgram : public EditProgram {
  protected:
    /// Returns a job that edits the cube with the smallest prior. `more` adds columns.
    json job(const std::string& to, const json& more = json::object()) const {
        json values = {{"model", "cube.obj"},    {"from", "a red cube"}, {"to", to},
                       {"prior", "pipeline_sd"}, {"resolution", 32},     {"batch", 1},
                       {"iterations", 3},        {"texture-size", 64},   {"image-size", 32}};
        values.update(more);
        return values;
    }
    std::string jobs_file(const std::vector<json>& jobs, const std::string& name = "jobs.jsonl") {
        std::ofstream file(folder_ / name);
        for (const json& one : jobs)
            file << one.dump() << '\n';
        return quoted(folder_ / name);
    }
    std::string batch(const std::string& jobs, const std::string& rest = "") const {
        return "batch " + jobs + " -o " + quoted(folder_ / "out") + " --quiet --threads 1 " + rest;
    }
    json status() const {
        return json::parse(run("batch status " + quoted(folder_ / "out") + " --json").out);
    }
    /// Returns the folders of results, by target sentence.
    std::map<std::string, fs::path> results() const {
        std::map<std::string, fs::path> found;
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out" / "runs"))
            if (entry.path().filename() == "edit.json" &&
                entry.path().parent_path().filename() == "result")
                found[json::parse(read_file(entry.path()))["to"]] = entry.path().parent_path();
        return found;
    }
    /// Returns the contents of a folder's model and textures, by relative path.
    static std::map<std::string, std::string> products(const fs::path& folder) {
        std::map<std::string, std::string> files = {{"model", read_file(folder / "model.glb")}};
        for (const auto& entry : fs::directory_iterator(folder / "textures"))
            files[entry.path().filename()] = read_file(entry.path());
        return files;
    }
};

TEST_F(BatchProgram, MakesWhatTheCommandMakesAndNothingTwice) {
    setenv("SOURCE_DATE_EPOCH", "0", 1);
    const std::string file =
        jobs_file({job("a blue {name}"),
                   job("a golden {name}", {{"name", "gold"}}),
                   job("a wooden cube", {{"after", "gold"}, {"model", nullptr}}),
                   {{"model", "cube.obj"},
                    {"command", "relight"},
                    {"light", "small.hdr"},
                    {"from_light", "small.hdr"},
                    {"views", 1},
                    {"frames", 2},
                    {"size", 16}}});
    const Result first = run(batch(file));
    ASSERT_EQ(first.code, 0) << first.error;
    EXPECT_EQ(first.out, (folder_ / "out" / "index.html").string() + "\n");
    const auto found = results();
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(status()["done"], 4);

    // The same edit alone loads its own prior, instead of one that was kept from another edit.
    const Result alone = run(edit(" --threads 1 --from 'a red cube' --to 'a golden cube' -o " +
                                  quoted(folder_ / "alone")));
    ASSERT_EQ(alone.code, 0) << alone.error;
    EXPECT_EQ(products(found.at("a golden cube")), products(folder_ / "alone"));
    const auto rows_of = [](const fs::path& folder) {
        return json::parse(read_file(folder / "edit.json"))["unet_rows"];
    };
    EXPECT_EQ(rows_of(found.at("a golden cube")), rows_of(folder_ / "alone"));

    const auto time = fs::last_write_time(found.at("a blue cube") / "model.glb");
    jobs_file({job("a blue {name}"), job("a silver {name}", {{"name", "gold"}})});
    ASSERT_EQ(run(batch(file, "--variants")).code, 0);
    const fs::path looks = folder_ / "out" / "variants" / "cube.glb";
    EXPECT_EQ(run("render " + quoted(looks) + small_light() +
                  "--size 16 --variant 'silver cube' -o " + quoted(folder_ / "look.png"))
                  .code,
              0);
    EXPECT_EQ(fs::last_write_time(found.at("a blue cube") / "model.glb"), time) << "done once";
    EXPECT_TRUE(results().contains("a silver cube"));
    EXPECT_EQ(status()["jobs"], 4) << "the golden one's place was taken";
    const std::string table = read_file(folder_ / "out" / "results.csv");
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 5);
    EXPECT_NE(table.find("scores.detail_kept"), std::string::npos);
    EXPECT_NE(read_file(folder_ / "out" / "index.html").find("data:image/webp"), std::string::npos);
}

TEST_F(BatchProgram, AKilledWorkerLosesNothing) {
    setenv("SOURCE_DATE_EPOCH", "0", 1);
    std::vector<json> jobs;
    for (int i = 0; i < 6; ++i)
        jobs.push_back(job("a blue cube", {{"seed", i}, {"iterations", 30}}));
    const std::string file = jobs_file(jobs);
    std::thread running([&] { EXPECT_EQ(run(batch(file, "--workers 2")).code, 0); });
    std::set<int> killed;
    for (int tenths = 0; tenths < 500 && killed.size() < 3; ++tenths) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        std::error_code code;
        for (const auto& entry : fs::directory_iterator(folder_ / "out" / "workers", code)) {
            if (entry.path().extension() != ".json") continue;
            const json heart = json::parse(read_file(entry.path()), nullptr, false);
            if (!heart.is_object() || heart["job"] == "" || heart["ended"] == true) continue;
            const int pid = heart["process"]["pid"];
            if (killed.size() < 3 && killed.insert(pid).second) ::kill(pid, SIGKILL);
        }
    }
    running.join();
    EXPECT_EQ(killed.size(), 3u);
    const json end = status();
    EXPECT_EQ(end["done"], 6);
    EXPECT_GE(end["retried"], 1);
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out" / "runs")) {
        const std::string name = entry.path().filename();
        if (name == "result") ++count;
        EXPECT_FALSE(name.starts_with("attempt-") || name.starts_with("waiting-")) << name;
    }
    EXPECT_EQ(count, 6u);
    const Result alone = run("edit " + quoted(cube_) + " --prior '" + prior() +
                             "' --resolution 32 --batch 1 --iterations 30 --texture-size 64 "
                             "--image-size 32 --threads 1 --seed 5 --from 'a red cube' --to "
                             "'a blue cube' -o " +
                             quoted(folder_ / "alone"));
    ASSERT_EQ(alone.code, 0) << alone.error;
    std::set<std::string> models;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out" / "runs"))
        if (entry.path().filename() == "model.glb") models.insert(read_file(entry.path()));
    EXPECT_TRUE(models.contains(read_file(folder_ / "alone" / "model.glb")));
}

TEST_F(BatchProgram, WhatIsWrongFailsAloneOrIsToldAtOnce) {
    expect_error(batch(jobs_file({job("a", {{"iteratons", 3}})})), 3, "did you mean 'iterations'");
    expect_error(batch(jobs_file({job("a", {{"iterations", "many"}})})), 3, "line 1");
    expect_error(batch(jobs_file({job("a", {{"resolution", -1}})})), 3, "--resolution");
    expect_error(batch(jobs_file({job("a", {{"after", "b"}, {"name", "b"}, {"model", nullptr}})})),
                 3, "form a cycle");
    expect_error(batch(""), 2, "a file of jobs is required");
    expect_error("batch status " + quoted(folder_), 3, "is not the folder of a batch");
    expect_error("batch " + jobs_file({job("a")}) + " -o " + quoted(folder_), 3,
                 "do not belong to a batch");
    expect_error("batch --models " + quoted(cube_) + " -o " + quoted(folder_ / "out"), 2,
                 "--from and --to");
    EXPECT_FALSE(fs::exists(folder_ / "out"));

    std::ofstream(folder_ / "broken.glb") << "no model";
    const std::string file = jobs_file({job("a", {{"model", "none.glb"}}),
                                        job("b", {{"model", "broken.glb"}}), job("a blue cube")});
    expect_error(batch(file), 3, "2 of 3 jobs failed");
    EXPECT_EQ(status()["done"], 1);
    EXPECT_NE(status()["failed"][0]["message"].get<std::string>().find("no such file"),
              std::string::npos);
    // After the repair, the row is another job, which replaces the failed one.
    fs::copy(cube_, folder_ / "none.glb");
    expect_error(batch(file), 3, "2 of 3 jobs failed");
    EXPECT_EQ(status()["jobs"], 3);
}

TEST_F(BatchProgram, AFullDiskStopsItWithoutAFailure) {
    const std::string file = jobs_file({job("a blue cube"), job("a golden cube")});
    expect_error(batch(file), 4, "no more jobs are claimed",
                 "ulimit -f 4; ");  // file size limit of 4 kB
    EXPECT_EQ(status()["failed"].size(), 0u);
    EXPECT_EQ(status()["waiting"], 2);
    ASSERT_EQ(run(batch(file)).code, 0);
    EXPECT_EQ(status()["done"], 2);
}

}  // namespace
}  // namespace item3d::testing
