#include "item3d/batch/batch_view.h"
#include "item3d/batch/claim.h"
#include "item3d/batch/gallery.h"
#include "item3d/batch/remove_jobs.h"
#include "item3d/batch/results_table.h"
#include "item3d/batch/retry.h"
#include "item3d/batch/status.h"
#include "item3d/batch/worker.h"
#include "item3d/core/csv.h"
#include "item3d/core/disk_full.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "tests/batch/folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <map>
#include <mutex>
#include <thread>

namespace item3d {
namespace {

using namespace std::chrono_literals;

WorkerOptions fast() {
    WorkerOptions options;
    options.look_every = 5ms;
    options.beat_every = 5ms;
    options.stale_after = 10s;
    return options;
}

nlohmann::json leave_model(const ClaimedJob& job) {
    write_atomically(job.folder / "model.glb", std::string_view(job.job.id));
    return {{"scores", {{"detail_kept", 0.5}}}};
}

class Workers : public item3d::testing::BatchTest {
  protected:
    BatchStatus status() {
        view_ = std::make_unique<BatchView>(batch());
        return status_of(batch(), *view_);
    }
    /// Returns a job's state according to its folder and the journals.
    const BatchEntry& entry(const std::string& id) { return view_->entry(*view_->find(id)); }
    std::unique_ptr<BatchView> view_;
};

TEST_F(Workers, SeveralShareTheJobsAndEachIsRunOnce) {
    batch().add_jobs(jobs(60));
    std::mutex mutex;
    std::map<std::string, int> runs;
    const auto work = [&](std::size_t index) {
        WorkerOptions options = fast();
        options.index = index;
        run_worker(batch(), options, [&](const ClaimedJob& job) {
            {
                const std::lock_guard lock(mutex);
                ++runs[job.job.id];
            }
            std::this_thread::sleep_for(1ms);
            return leave_model(job);
        });
    };
    std::thread first(work, 0), second(work, 1), third(work, 2);
    first.join();
    second.join();
    third.join();
    EXPECT_EQ(runs.size(), 60u);
    for (const auto& [id, count] : runs)
        EXPECT_EQ(count, 1) << id;
    const BatchStatus end = status();
    EXPECT_EQ(end.done, 60u);
    EXPECT_EQ(end.waiting + end.failed + end.running.size(), 0u);
    const std::string csv = results_csv(*view_);
    EXPECT_EQ(parse_csv(csv, "results").size(), 61u);
    EXPECT_NE(csv.find("scores.detail_kept"), std::string::npos);
    // A second run does nothing.
    run_worker(batch(), fast(),
               [](const ClaimedJob&) -> nlohmann::json { throw Error(ExitCode::bug, "again"); });
}

TEST_F(Workers, AfterAnotherMeansItsModelAndItsFailure) {
    batch().add_jobs({job("c", "b"), job("b", "a"), job("a"), job("lost", "bad"), job("bad"),
                      job("loster", "lost")});
    std::vector<std::string> order;
    run_worker(batch(), fast(), [&](const ClaimedJob& job) {
        order.push_back(job.job.id);
        if (job.job.id == "bad") throw InputError("bad.glb", "is broken");
        EXPECT_EQ(job.job.after.empty() ? "" : read_text(job.model), job.job.after);
        return leave_model(job);
    });
    EXPECT_EQ(std::count(order.begin(), order.end(), "lost"), 0);
    const auto place = [&](const char* id) { return std::find(order.begin(), order.end(), id); };
    EXPECT_LT(place("a"), place("b"));
    EXPECT_LT(place("b"), place("c"));
    const BatchStatus end = status();
    EXPECT_EQ(end.done, 3u);
    EXPECT_EQ(end.failed, 3u);
    EXPECT_EQ(entry("bad").last.message, "bad.glb: is broken");
    EXPECT_EQ(entry("loster").last.message, "the job that it comes after (lost) failed");

    // After the repair, all three are done.
    EXPECT_EQ(retry_failed_jobs(batch()), 3u);
    run_worker(batch(), fast(), leave_model);
    EXPECT_EQ(status().done, 6u);
}

TEST_F(Workers, ErrorsThatMayPassAreTriedAgainAndCounted) {
    batch().add_jobs({job("once"), job("always"), job("good")});
    std::map<std::string, int> runs;
    run_worker(batch(), fast(), [&](const ClaimedJob& job) {
        const int run = ++runs[job.job.id];
        if (job.job.id == "always" || (job.job.id == "once" && run == 1))
            throw ResourceError("out of memory\nand more");
        return leave_model(job);
    });
    EXPECT_EQ(runs["once"], 2);
    EXPECT_EQ(runs["always"], 3) << "two retries";
    const BatchStatus end = status();
    EXPECT_EQ(end.done, 2u);
    EXPECT_EQ(end.retried, 2u);
    EXPECT_EQ(entry("always").last.message, "out of memory");
    EXPECT_EQ(entry("once").last.errors, 1);
}

TEST_F(Workers, AFullDiskStopsTheWorkerAndLosesNothing) {
    batch().add_jobs(jobs(3));
    int runs = 0;
    EXPECT_THROW(run_worker(batch(), fast(),
                            [&](const ClaimedJob& job) -> nlohmann::json {
                                if (++runs == 2) throw DiskFull("model.glb: no space");
                                return leave_model(job);
                            }),
                 DiskFull);
    EXPECT_EQ(runs, 2);
    const BatchStatus then = status();
    EXPECT_EQ(then.done, 1u);
    EXPECT_EQ(then.waiting, 2u);
    EXPECT_EQ(then.released, 1u);
    run_worker(batch(), fast(), leave_model);
    EXPECT_EQ(status().done, 3u);
}

TEST_F(Workers, AKilledWorkersJobGoesOnFromItsCheckpointAndIsCounted) {
    batch().add_jobs(jobs(2));
    const pid_t child = ::fork();
    if (child == 0) {
        run_worker(batch(), fast(), [](const ClaimedJob& job) -> nlohmann::json {
            write_atomically(job.folder / "checkpoint.safetensors", std::string_view("half"));
            ::raise(SIGKILL);
            return nullptr;
        });
        ::_exit(0);
    }
    int code = 0;
    ::waitpid(child, &code, 0);
    ASSERT_TRUE(WIFSIGNALED(code));
    int resumed = 0;
    run_worker(batch(), fast(), [&](const ClaimedJob& job) {
        if (job.resume) {
            ++resumed;
            EXPECT_EQ(read_text(job.folder / "checkpoint.safetensors"), "half");
        }
        return leave_model(job);
    });
    EXPECT_EQ(resumed, 1);
    EXPECT_EQ(status().done, 2u);
    EXPECT_EQ(entry("job0").last.deaths + entry("job1").last.deaths, 1);
    for (const char* id : {"job0", "job1"})
        EXPECT_FALSE(
            fs::exists(result_folder(batch().folder_of(entry(id).job)) / "checkpoint.safetensors"));
}

TEST_F(Workers, AJobThatKillsItsWorkersIsGivenUp) {
    batch().add_jobs({job("poison")});
    WorkerOptions options = fast();
    options.limits.max_deaths = 1;
    for (int i = 0; i < 2; ++i) {
        const pid_t child = ::fork();
        if (child == 0) {
            run_worker(batch(), options, [](const ClaimedJob&) -> nlohmann::json {
                ::raise(SIGKILL);
                return nullptr;
            });
            ::_exit(0);
        }
        ::waitpid(child, nullptr, 0);
    }
    run_worker(batch(), options, leave_model);
    EXPECT_EQ(status().failed, 1u);
    EXPECT_NE(entry("poison").last.message.find("died 2 times"), std::string::npos);
}

TEST_F(Workers, AWorkerThatWasStoppedForLongPublishesNothing) {
    batch().add_jobs(jobs(1));
    const WorkerCounts counts = run_worker(batch(), fast(), [&](const ClaimedJob& job) {
        // In the meantime another worker takes the job over and finishes it.
        const fs::path folder = batch().folder_of(job.job);
        const auto other = Claim::take(folder, look_at(folder), "other");
        write_atomically(other->folder() / "model.glb", std::string_view("other"));
        EXPECT_TRUE(other->publish(FolderState::done));
        fs::create_directories(job.folder);
        return leave_model(job);
    });
    EXPECT_EQ(counts.lost, 1u);
    EXPECT_EQ(counts.done, 0u);
    EXPECT_EQ(status().done, 1u);
    EXPECT_EQ(read_text(result_folder(batch().folder_of(entry("job0").job)) / "model.glb"),
              "other");
}

TEST_F(Workers, JobsThatAreAddedMeanwhileAreDoneAndReplacedOnesAreNot) {
    batch().add_jobs({job("a"), job("b")});
    std::vector<std::string> order;
    run_worker(batch(), fast(), [&](const ClaimedJob& claimed) {
        order.push_back(claimed.job.id);
        if (claimed.job.id == "a") {
            BatchJob other = job("other");
            other.key = "b";  // b requested with another option
            batch().add_jobs({other, job("new")});
            std::this_thread::sleep_for(10ms);
        }
        return leave_model(claimed);
    });
    EXPECT_EQ(order, (std::vector<std::string>{"a", "other", "new"}));
    EXPECT_EQ(status().jobs, 3u);
    // The first one is requested again.
    batch().add_jobs({job("b")});
    run_worker(batch(), fast(), leave_model);
    EXPECT_EQ(status().done, 3u);
    EXPECT_EQ(entry("b").state, JobState::done);
}

TEST_F(Workers, JobsThatAreRemovedAreNotDoneUntilTheyAreAskedForAgain) {
    batch().add_jobs({job("a"), job("b"), job("c", "b"), job("d")});
    EXPECT_THROW(remove_jobs(batch(), {"a", "bb"}), InputError);
    EXPECT_THROW(remove_jobs(batch(), {"b"}), InputError) << "c comes after it";
    EXPECT_EQ(remove_jobs(batch(), {"b", "c", batch().folder_of(job("a")).filename().string()}),
              3u);
    run_worker(batch(), fast(), leave_model);
    EXPECT_EQ(status().done, 1u);
    EXPECT_EQ(view_->open_count(), 0u);
    batch().add_jobs({job("a")});
    EXPECT_EQ(status().waiting, 1u);
    run_worker(batch(), fast(), leave_model);
    EXPECT_EQ(status().done, 2u);
    EXPECT_EQ(entry("a").state, JobState::done);
}

TEST_F(Workers, WarningsOfAllAttemptsAreKeptWithTheJob) {
    batch().add_jobs({job("warned"), job("silent")});
    int run = 0;
    run_worker(batch(), fast(), [&](const ClaimedJob& claimed) {
        if (claimed.job.id == "silent") return leave_model(claimed);
        warn("the UV map overlaps");
        if (++run == 1) throw ResourceError("out of memory");
        warn("a texture is small");
        return leave_model(claimed);
    });
    const std::vector<std::string> both{"the UV map overlaps", "a texture is small"};
    const BatchStatus end = status();
    EXPECT_EQ(entry("warned").last.warnings, both);
    EXPECT_TRUE(entry("silent").last.warnings.empty());
    ASSERT_EQ(end.warned.size(), 1u);
    EXPECT_EQ(status_json(end, *view_)["warned"][0]["warnings"], nlohmann::json(both));
    EXPECT_NE(gallery_html(batch(), *view_).find("a texture is small"), std::string::npos);
    EXPECT_NE(results_csv(*view_).find("a texture is small"), std::string::npos);
}

TEST_F(Workers, AResultThatNoJournalTellsOfIsFound) {
    batch().add_jobs(jobs(2));
    BatchView before(batch());
    const auto claim = Claim::begin(batch().folder_of(before.entry(0).job), "killed");
    write_atomically(claim->folder() / "model.glb", std::string_view("it"));
    ASSERT_TRUE(claim->publish(FolderState::done));
    EXPECT_EQ(status().done, 1u);
    const WorkerCounts counts = run_worker(batch(), fast(), leave_model);
    EXPECT_EQ(counts.done, 1u);
    EXPECT_EQ(BatchView(batch()).open_count(), 0u) << "the journal knows by now";
}

TEST_F(Workers, JobsOfAnotherVersionAreLeftAlone) {
    BatchJob old = job("old");
    old.version = "0.0.1";
    batch().add_jobs({old});
    EXPECT_THROW(run_worker(batch(), fast(), leave_model), InputError);
    EXPECT_EQ(status().waiting, 1u);
}

TEST_F(Workers, TheGalleryHasFailuresAndEscapesWhatPeopleWrote) {
    BatchJob good = job("good");
    good.to = "a </script><b>mug";
    batch().add_jobs({good, job("bad")});
    run_worker(batch(), fast(), [](const ClaimedJob& claimed) {
        if (claimed.job.id == "bad") throw InputError("bad.glb", "is broken");
        write_atomically(claimed.folder / before_thumbnail, std::string_view("RIFF0000WEBP"));
        return leave_model(claimed);
    });
    status();
    const std::string page = gallery_html(batch(), *view_);
    EXPECT_NE(page.find("bad.glb: is broken"), std::string::npos);
    EXPECT_NE(page.find("data:image/webp;base64"), std::string::npos);
    EXPECT_NE(page.find("a <\\/script><b>mug"), std::string::npos);
    EXPECT_EQ(page.find("{{"), std::string::npos);
    EXPECT_EQ(page.find("http"), std::string::npos) << "nothing is fetched";
}

}  // namespace
}  // namespace item3d
