// Fixture of the batch tests: a batch's folder, and jobs without models.
#pragma once

#include "item3d/batch/batch_folder.h"
#include "item3d/core/version.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d::testing {

namespace fs = std::filesystem;

class BatchTest : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("item3d_batch_" + std::to_string(::getpid()));
        fs::remove_all(folder_);
        batch_ = std::make_unique<BatchFolder>(BatchFolder::create(folder_));
    }
    void TearDown() override { fs::remove_all(folder_); }

    const BatchFolder& batch() const { return *batch_; }

    /// Returns a job with this id, name and key.
    static BatchJob job(const std::string& id, const std::string& after = "") {
        BatchJob job;
        job.id = id;
        job.name = id;
        job.key = id;
        job.place = id;
        job.command = "edit";
        job.after = after;
        job.version = version();
        job.folder = job_folder_name(id, "job");
        return job;
    }
    static std::vector<BatchJob> jobs(int count) {
        std::vector<BatchJob> all;
        for (int i = 0; i < count; ++i)
            all.push_back(job("job" + std::to_string(i)));
        return all;
    }

    fs::path folder_;
    std::unique_ptr<BatchFolder> batch_;
};

}  // namespace item3d::testing
