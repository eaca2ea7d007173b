// Tests of batch folders: created once by any process, and distinguished from other folders.
#include "item3d/core/files.h"
#include "tests/batch/folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

TEST(BatchFolders, SeveralMayMakeOneAtOnceAndAnInterruptedOneIsMade) {
    const fs::path folder =
        fs::temp_directory_path() / ("item3d_race_" + std::to_string(::getpid()));
    for (int round = 0; round < 50; ++round) {
        fs::remove_all(folder);
        std::vector<pid_t> makers;
        for (int i = 0; i < 4; ++i) {
            makers.push_back(::fork());
            if (makers.back() != 0) continue;
            try {
                BatchJob job;
                job.id = job.key = "one";
                BatchFolder::create(folder).add_jobs({job});
            } catch (const std::exception&) {
                std::_Exit(1);
            }
            std::_Exit(0);
        }
        for (const pid_t maker : makers) {
            int status = -1;
            ::waitpid(maker, &status, 0);
            EXPECT_EQ(status, 0);
        }
    }
    fs::remove_all(folder);
    fs::create_directories(folder / "jobs");
    fs::create_directories(folder / "workers");
    EXPECT_FALSE(BatchFolder::is_begun(folder));
    BatchFolder::create(folder);
    EXPECT_TRUE(BatchFolder::is_begun(folder));
    fs::remove_all(folder);
}

TEST(BatchFolders, OfSomethingElseAreRefused) {
    const fs::path folder =
        fs::temp_directory_path() / ("item3d_other_" + std::to_string(::getpid()));
    fs::create_directories(folder);
    write_atomically(folder / "photo.png", std::string_view("x"));
    EXPECT_THROW(BatchFolder::create(folder), InputError);
    EXPECT_THROW(BatchFolder::open(folder), InputError);
    write_atomically(folder / "batch.json", std::string_view(R"({"format": "item3d batch 9"})"));
    EXPECT_THROW(BatchFolder::create(folder), InputError);
    fs::remove_all(folder);
}

}  // namespace
}  // namespace item3d
