// Tests of the queue: edits that end, fail, are paused, cancelled and resumed, and a server that is
// killed.
#include "item3d/core/error.h"
#include "item3d/serve/sqlite.h"
#include "tests/support/studio.h"

namespace item3d::testing {
namespace {

namespace fs = std::filesystem;

class StudioQueue : public StudioFolder {
  protected:
    void SetUp() override {
        StudioFolder::SetUp();
        studio_ = std::make_unique<Studio>(options_);
        project_ = studio_->open_model(folder_ / "mug.glb", "mug.glb").id;
    }
    void TearDown() override {
        studio_.reset();
        StudioFolder::TearDown();
    }
    std::int64_t add(const std::string& to) { return studio_->jobs().add(edit(project_, to)).id; }
    fs::path file(std::int64_t result, const std::string& name) const {
        return studio_->folders().result(project_, result) / name;
    }
    bool reaches(std::int64_t result, ResultState state) {
        return wait_for(*studio_, result, state);
    }
    /// Waits until the edit has written its first texture. Returns false if it does not.
    bool shows_texture(std::int64_t result) {
        return wait_until([&] { return fs::exists(file(result, "live/textures.json")); });
    }

    std::unique_ptr<Studio> studio_;
    std::int64_t project_ = 0;
};

TEST_F(StudioQueue, RunsEditsOneAfterTheOther) {
    std::int64_t after = studio_->events().last();
    const std::int64_t first = add("a golden mug"), second = add("a rusty mug");
    EXPECT_TRUE(reaches(second, ResultState::done));
    const StudioResult done = studio_->result(first);
    EXPECT_EQ(done.state, ResultState::done);
    EXPECT_EQ(done.scores["detail_kept"], 0.9);
    EXPECT_GT(done.seconds, 0.05);
    EXPECT_EQ(done.command,
              "item3d edit source/mug.glb '--from=a red mug' '--to=a golden mug' -o "
              "results/" +
                  std::to_string(first));
    EXPECT_EQ(done.files,
              (std::vector<std::string>{"edit.json", "lines.txt", "log.txt", "model.glb"}));
    const std::string told = studio_->events().wait(after, std::chrono::milliseconds(1));
    EXPECT_NE(told.find("event: preview"), std::string::npos);
    EXPECT_NE(told.find("files/live/0_base_color.png?revision=1"), std::string::npos);
}

TEST_F(StudioQueue, EditsAnEdit) {
    const std::int64_t first = add("a golden mug");
    ASSERT_TRUE(reaches(first, ResultState::done));
    StudioResult child = edit(project_, "a rusty mug");
    child.parent = first;
    const std::int64_t second = studio_->jobs().add(child).id;
    ASSERT_TRUE(reaches(second, ResultState::done));
    EXPECT_NE(
        read(file(second, "lines.txt")).find("results/" + std::to_string(first) + "/model.glb"),
        std::string::npos);
    child.parent = second + 100;
    EXPECT_THROW(studio_->jobs().add(child), InputError);
}

TEST_F(StudioQueue, SaysWhyAnEditFailed) {
    const std::int64_t failed = add("a broken mug"), next = add("a golden mug");
    EXPECT_TRUE(reaches(next, ResultState::done)) << "the queue goes on";
    EXPECT_EQ(studio_->result(failed).state, ResultState::failed);
    EXPECT_EQ(studio_->result(failed).message, "projects/1/source: cannot be; try another");
}

TEST_F(StudioQueue, SaysWhyAnEditDoesNotBegin) {
    Sqlite database(options_.folder / "studio.sqlite", false);
    database.run(
        "CREATE TRIGGER full BEFORE UPDATE OF state ON results WHEN NEW.state <> 'waiting' "
        "BEGIN SELECT RAISE(ABORT, 'no space'); END");
    const std::int64_t id = add("a golden mug");
    const auto told = [&] { return studio_->jobs().with_status(studio_->result(id)).message; };
    EXPECT_TRUE(wait_until([&] { return !told().empty(); }));
    EXPECT_EQ(told().find("studio.sqlite: cannot be read or written (no space); check the disk"),
              0u)
        << told();
    database.run("DROP TRIGGER full");
    EXPECT_TRUE(reaches(id, ResultState::done));
    EXPECT_TRUE(wait_until([&] { return told().empty(); }));
}

TEST_F(StudioQueue, PausesAndResumes) {
    const std::int64_t slow = add("a slow mug"), next = add("a golden mug");
    ASSERT_TRUE(shows_texture(slow));
    studio_->jobs().pause(next);
    EXPECT_EQ(studio_->result(next).state, ResultState::paused) << "it waited";
    studio_->jobs().pause(slow);
    ASSERT_TRUE(reaches(slow, ResultState::paused));
    EXPECT_EQ(read(file(slow, "checkpoint.safetensors")), "kept\n");
    studio_->jobs().resume(slow);
    ASSERT_TRUE(reaches(slow, ResultState::done));
    EXPECT_NE(read(file(slow, "lines.txt")).find("--resume"), std::string::npos);
    EXPECT_FALSE(fs::exists(file(slow, "checkpoint.safetensors")));
    EXPECT_EQ(studio_->result(next).state, ResultState::paused);
}

TEST_F(StudioQueue, CancelsAndRemoves) {
    const std::int64_t slow = add("a slow mug"), waiting = add("a golden mug");
    ASSERT_TRUE(shows_texture(slow));
    studio_->jobs().cancel(waiting);
    studio_->jobs().cancel(slow);
    EXPECT_TRUE(reaches(slow, ResultState::cancelled));
    EXPECT_EQ(studio_->result(waiting).state, ResultState::cancelled);
    const fs::path folder = file(slow, "");
    studio_->jobs().remove(slow);
    EXPECT_FALSE(fs::exists(folder));
    EXPECT_THROW(studio_->result(slow), InputError);
    const std::int64_t again = add("a slow mug");
    ASSERT_TRUE(shows_texture(again));
    EXPECT_THROW(studio_->remove_project(project_), InputError) << "while it runs";
    studio_->jobs().remove(again);
    EXPECT_TRUE(wait_until([&] { return !studio_->store().result(again); }));
    studio_->remove_project(project_);
    EXPECT_FALSE(fs::exists(studio_->folders().project(project_)));
}

TEST_F(StudioQueue, ShowsAsPausedWhatRanWhenTheServerEnded) {
    const std::int64_t slow = add("a slow mug"), next = add("a golden mug");
    ASSERT_TRUE(shows_texture(slow));
    studio_.reset();
    EXPECT_TRUE(fs::exists(options_.folder / "projects/1/results/1/checkpoint.safetensors"));
    {
        // The database is in the state that a killed server leaves.
        StudioStore store(options_.folder);
        StudioResult killed = *store.result(slow);
        EXPECT_EQ(killed.state, ResultState::paused);
        killed.state = ResultState::running;
        store.update_result(killed);
    }
    studio_ = std::make_unique<Studio>(options_);
    EXPECT_EQ(studio_->result(slow).state, ResultState::paused);
    EXPECT_TRUE(reaches(next, ResultState::done)) << "what waited goes on waiting for its turn";
    studio_->jobs().resume(slow);
    EXPECT_TRUE(reaches(slow, ResultState::done));
}

TEST_F(StudioQueue, ForgetsAModelThatWasNotReadWhenTheServerWasKilled) {
    studio_.reset();
    std::int64_t unread = 0;
    {
        StudioStore store(options_.folder);
        unread = store.add_project("half.glb");
    }
    fs::create_directories(options_.folder / "projects" / std::to_string(unread) / "source");
    studio_ = std::make_unique<Studio>(options_);
    EXPECT_THROW(studio_->project(unread), InputError);
    EXPECT_FALSE(fs::exists(studio_->folders().project(unread)));
    EXPECT_NO_THROW(studio_->project(project_));
}

TEST_F(StudioQueue, KnowsWhatTheCommandLineEnded) {
    const std::int64_t slow = add("a slow mug");
    ASSERT_TRUE(shows_texture(slow));
    studio_.reset();
    write(options_.folder / "projects/1/results/1/edit.json",
          R"({"scores": {"detail_kept": 0.5}})");
    studio_ = std::make_unique<Studio>(options_);
    EXPECT_EQ(studio_->result(slow).state, ResultState::done);
    EXPECT_EQ(studio_->result(slow).scores["detail_kept"], 0.5);
}

TEST_F(StudioQueue, RunsNothingAgainThatTheCommandLineHasEnded) {
    const std::int64_t slow = add("a slow mug");
    ASSERT_TRUE(shows_texture(slow));
    studio_->jobs().pause(slow);
    ASSERT_TRUE(reaches(slow, ResultState::paused));
    const std::string lines = read(file(slow, "lines.txt"));
    write(file(slow, "edit.json"), R"({"scores": {"detail_kept": 0.5}})");
    studio_->jobs().resume(slow);
    ASSERT_TRUE(reaches(slow, ResultState::done));
    EXPECT_EQ(studio_->result(slow).scores["detail_kept"], 0.5);
    EXPECT_EQ(read(file(slow, "lines.txt")), lines);
}

TEST_F(StudioQueue, ReconstructsPhotographs) {
    program("item3d-reconstruct", stand_in_for_edit);
    fs::create_directories(options_.folder / "incoming/photographs");
    write(options_.folder / "incoming/photographs/1.jpg", "");
    StudioResult made = studio_->reconstruct(options_.folder / "incoming/photographs", "");
    ASSERT_TRUE(wait_until([&] { return has_ended(studio_->result(made.id).state); }));
    EXPECT_EQ(studio_->result(made.id).state, ResultState::failed) << "the stand-in makes no model";
    EXPECT_EQ(studio_->project(made.project).name, "Photographs");
    EXPECT_NE(made.command.find("item3d reconstruct --from-images=photographs"), std::string::npos);

    const fs::path folder = studio_->folders().result(made.project, made.id);
    fs::remove(folder / "edit.json");  // the stand-in wrote it, but a reconstruction writes none
    write(folder / "checkpoint.safetensors", "kept\n");
    studio_->jobs().resume(made.id);
    ASSERT_TRUE(wait_until([&] { return has_ended(studio_->result(made.id).state); }));
    EXPECT_NE(read(folder / "lines.txt").find("--resume"), std::string::npos)
        << "it began again from nothing";
}

}  // namespace
}  // namespace item3d::testing
