#include "item3d/batch/attempt.h"
#include "item3d/batch/claim.h"
#include "item3d/batch/heartbeat.h"
#include "item3d/batch/worker_watch.h"
#include "item3d/core/disk_full.h"
#include "item3d/core/files.h"
#include "tests/batch/folder.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class Claims : public item3d::testing::BatchTest {};

TEST_F(Claims, OneOfManyBeginsAJob) {
    const fs::path job = folder_ / "runs/ab/job";
    std::atomic<int> winners = 0;
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i)
        threads.emplace_back([&, i] {
            if (Claim::begin(job, "w" + std::to_string(i))) ++winners;
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(winners, 1);
    EXPECT_EQ(look_at(job).state, FolderState::running);
}

TEST_F(Claims, OneOfManyTakesAJobOverAndTheOldOwnerFindsOut) {
    const fs::path job = folder_ / "runs/ab/job";
    const auto old = Claim::begin(job, "old");
    ASSERT_TRUE(old);
    write_atomically(old->folder() / "checkpoint.safetensors", std::string_view("half"));
    write_atomically(old->folder() / "model.tmp7.glb", std::string_view("torn"));
    const FolderLook look = look_at(job);
    EXPECT_EQ(look.worker, "old");
    std::atomic<int> winners = 0;
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i)
        threads.emplace_back([&, i] {
            if (Claim::take(job, look, "w" + std::to_string(i))) ++winners;
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(winners, 1);
    const FolderLook now = look_at(job);
    EXPECT_EQ(now.attempt, 2);
    EXPECT_EQ(read_text(now.current / "checkpoint.safetensors"), "half") << "handed on";
    EXPECT_FALSE(fs::exists(now.current / "model.tmp7.glb")) << "of the one that was killed";

    EXPECT_FALSE(old->is_held());
    EXPECT_THROW(write_atomically(old->folder() / "model.glb", std::string_view("old")), Error);
    // A worker that has lost its claim and recreates the folder cannot publish either.
    fs::create_directories(old->folder());
    write_atomically(old->folder() / "model.glb", std::string_view("old"));
    EXPECT_FALSE(old->publish(FolderState::done));
    EXPECT_FALSE(old->release());
    EXPECT_EQ(look_at(job).state, FolderState::running);
}

TEST_F(Claims, AResultIsPublishedOnce) {
    const fs::path job = folder_ / "runs/ab/job";
    const auto first = Claim::begin(job, "a");
    write_atomically(first->folder() / "model.glb", std::string_view("a"));
    const auto second = Claim::take(job, look_at(job), "b");
    write_atomically(second->folder() / "model.glb", std::string_view("b"));
    EXPECT_TRUE(second->publish(FolderState::done));
    EXPECT_FALSE(first->publish(FolderState::done));
    EXPECT_FALSE(second->publish(FolderState::done));
    EXPECT_EQ(read_text(result_folder(job) / "model.glb"), "b");
    EXPECT_FALSE(Claim::begin(job, "c"));
    EXPECT_EQ(look_at(job).state, FolderState::done);
}

TEST_F(Claims, AReleasedJobGoesOnWhereItWas) {
    const fs::path job = folder_ / "runs/ab/job";
    const auto first = Claim::begin(job, "a");
    write_atomically(first->folder() / "checkpoint.safetensors", std::string_view("half"));
    EXPECT_TRUE(first->release());
    const FolderLook look = look_at(job);
    EXPECT_EQ(look.state, FolderState::waiting);
    const auto second = Claim::take(job, look, "b");
    ASSERT_TRUE(second);
    EXPECT_EQ(second->attempt(), 2);
    EXPECT_TRUE(fs::exists(second->folder() / "checkpoint.safetensors"));
    EXPECT_TRUE(second->publish(FolderState::failed));
    EXPECT_EQ(look_at(job).state, FolderState::failed);
    EXPECT_TRUE(retry_failed(job, 2));
    EXPECT_EQ(look_at(job).attempt, 3);
}

TEST_F(Claims, ALostWorkerIsToldByItsHeartbeatOnThisClock) {
    WorkerWatch watch(batch(), 60s);
    const auto begin = WorkerWatch::Clock::now();
    const auto beat = [&](int count, const std::string& job) {
        write_atomically(batch().workers() / "far.json",
                         std::string_view(nlohmann::json{{"beat", count}, {"job", job}}.dump()));
    };
    beat(1, "job");
    EXPECT_FALSE(watch.is_lost("job", "far", "1", begin));
    EXPECT_FALSE(watch.is_lost("job", "far", "1", begin + 59s));
    EXPECT_TRUE(watch.is_lost("job", "far", "1", begin + 61s));
    beat(2, "job");
    EXPECT_FALSE(watch.is_lost("job", "far", "1", begin + 62s)) << "it lives";
    EXPECT_FALSE(watch.is_lost("job", "far", "1", begin + 121s));
    EXPECT_TRUE(watch.is_lost("job", "far", "1", begin + 123s));
    // The heartbeat now names another job.
    beat(3, "other");
    EXPECT_FALSE(watch.is_lost("job", "far", "1", begin + 124s));
    beat(4, "other");
    EXPECT_TRUE(watch.is_lost("job", "far", "1", begin + 185s));
    // Worker "none" has no heartbeat file, and the claim of job "b" has no worker yet.
    EXPECT_FALSE(watch.is_lost("a", "none", "1", begin));
    EXPECT_TRUE(watch.is_lost("a", "none", "1", begin + 61s));
    EXPECT_FALSE(watch.is_lost("b", "", "0", begin));
    EXPECT_TRUE(watch.is_lost("b", "", "0", begin + 61s));
}

TEST_F(Claims, AWorkerThatEndedOrWhoseProcessIsGoneIsLostAtOnce) {
    WorkerWatch watch(batch(), 1h);
    std::string worker;
    {
        Heartbeat heartbeat(batch(), 10ms);
        worker = heartbeat.worker();
        heartbeat.set_job("job");
        EXPECT_FALSE(watch.is_lost("job", worker, "1"));
        const auto first = read_heartbeat(batch().workers() / (worker + ".json"));
        for (int i = 0; i < 500; ++i) {
            std::this_thread::sleep_for(10ms);
            if (read_heartbeat(batch().workers() / (worker + ".json"))["beat"] > first["beat"])
                break;
        }
        EXPECT_GT(read_heartbeat(batch().workers() / (worker + ".json"))["beat"], first["beat"]);
    }
    EXPECT_TRUE(watch.is_lost("job", worker, "1"));
    nlohmann::json gone = read_heartbeat(batch().workers() / (worker + ".json"));
    gone["ended"] = false;
    gone["process"]["start"] = "1";  // the same PID, but another process
    write_atomically(batch().workers() / "gone.json", std::string_view(gone.dump()));
    EXPECT_TRUE(watch.is_lost("job", "gone", "1"));
    gone["process"]["space"] = "another machine";
    write_atomically(batch().workers() / "gone.json", std::string_view(gone.dump()));
    EXPECT_FALSE(watch.is_lost("other", "gone", "1"));
}

}  // namespace
}  // namespace item3d
