// Tests of a batch's submission to Slurm, with stand-ins that record their arguments
// (scripts/slurm_test.sh tests a real one).
#include "item3d/batch/slurm/slurm_submit.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

namespace item3d {
namespace {

namespace fs = std::filesystem;

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

class Slurm : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("item3d_slurm_" + std::to_string(::getpid()));
        fs::create_directories(folder_ / "bin");
        fs::create_directories(folder_ / "my batch");
        path_ = std::getenv("PATH");
        ::setenv("PATH", ((folder_ / "bin").string() + ":/usr/bin:/bin").c_str(), 1);
        job_.program = "/opt/item3d/bin/item3d";
        job_.batch = folder_ / "my batch";
        add_program("scontrol", "echo 'MaxArraySize            = 3'");
        // The jobs get the ids 101, 102, ...
        add_program("sbatch", "echo \"$@\" >>" + quoted("calls") +
                                  "\necho 'a warning' >&2\necho $((100 + $(wc -l <" +
                                  quoted("calls") + ")))';cluster'");
        add_program("scancel", "echo \"$@\" >>" + quoted("cancelled"));
    }
    void TearDown() override {
        ::setenv("PATH", path_.c_str(), 1);
        fs::remove_all(folder_);
    }
    std::string quoted(const std::string& file) const {
        return "'" + (folder_ / file).string() + "'";
    }
    void add_program(const std::string& name, const std::string& script) const {
        const fs::path path = folder_ / "bin" / name;
        write_atomically(path, std::string_view("#!/bin/sh\n" + script + "\n"));
        fs::permissions(path, fs::perms::owner_all);
    }
    /// Returns what the stand-ins wrote to a file, with DIR in place of the batch's folder.
    std::string told(const std::string& file) const {
        std::string text = read_text(folder_ / file);
        for (std::size_t at; (at = text.find(job_.batch.string())) != std::string::npos;)
            text.replace(at, job_.batch.string().size(), "DIR");
        return text;
    }

    fs::path folder_;
    std::string path_;
    SlurmJob job_;
};

TEST_F(Slurm, WorkersBecomeAsFewArraysAsTheSiteTakes) {
    const SlurmSubmission submission = submit_to_slurm(job_, 7);
    EXPECT_EQ(submission.arrays, (std::vector<std::string>{"101", "102", "103"}));
    EXPECT_EQ(submission.summary, "104");
    EXPECT_EQ(told("calls"),
              "--parsable --array=0-2 DIR/slurm/workers.sh 0\n"
              "--parsable --array=0-2 DIR/slurm/workers.sh 3\n"
              "--parsable --array=0-0 DIR/slurm/workers.sh 6\n"
              "--parsable --dependency=afterany:101:102:103 DIR/slurm/summary.sh\n");
}

TEST_F(Slurm, WhatSbatchRefusesCancelsWhatItTook) {
    add_program("sbatch", "[ -e " + quoted("once") +
                              " ] && { echo 'Invalid partition' >&2; exit 1; }\n" + "touch " +
                              quoted("once") + "; echo 7");
    try {
        submit_to_slurm(job_, 4);
        FAIL() << "nothing was refused";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(),
                     "--slurm: sbatch failed: Invalid partition; check --sbatch-option");
    }
    EXPECT_EQ(told("cancelled"), "7\n");
}

TEST_F(Slurm, WithoutSlurmItIsAMissingResource) {
    fs::remove(folder_ / "bin" / "scontrol");
    ::setenv("PATH", (folder_ / "bin").string().c_str(), 1);
    EXPECT_THROW(submit_to_slurm(job_, 1), ResourceError);
}

TEST_F(Slurm, TheScriptSaysWhatWasAsked) {
    job_.threads = 4;
    job_.gpus_per_worker = 1;
    job_.sbatch_options = {"--partition=night", "--time=2:00:00"};
    job_.worker_arguments = {"--stale-seconds", "30", "it's"};
    const std::string script = worker_script(job_);
    for (const char* line :
         {"#!/bin/bash\n", "#SBATCH --requeue\n", "#SBATCH --signal=B:TERM@90\n",
          "#SBATCH --cpus-per-task=4\n", "#SBATCH --gpus-per-task=1\n",
          "#SBATCH --partition=night\n#SBATCH --time=2:00:00\n", "scontrol requeue \"$task\"\n"})
        EXPECT_TRUE(has(script, line)) << line << "\n" << script;
    EXPECT_TRUE(has(script, "/opt/item3d/bin/item3d batch work '" + job_.batch.string() +
                                "' --stale-seconds 30 'it'\\''s'"))
        << script;
    EXPECT_TRUE(has(summary_script(job_), "#SBATCH --partition=night\n"));
    const fs::path file = folder_ / "script.sh";
    write_atomically(file, std::string_view(script));
    EXPECT_EQ(std::system(("bash -n '" + file.string() + "'").c_str()), 0);
}

TEST_F(Slurm, ReadsTheLargestArray) {
    EXPECT_EQ(max_array_size_in("Licenses = (null)\nMaxArraySize            = 4001\nX = 1\n"),
              4001);
    EXPECT_EQ(max_array_size_in("MaxArraySize = (null)\nX = 1\n"), 1001);
    EXPECT_EQ(max_array_size_in(""), 1001);
}

}  // namespace
}  // namespace item3d
