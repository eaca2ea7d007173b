// Tests of the studio's database: stored data, deletion of projects, and files that are refused.
#include "item3d/studio/store.h"

#include "item3d/core/error.h"
#include "tests/support/studio.h"

namespace item3d::testing {
namespace {

using StudioDatabase = StudioFolder;

TEST_F(StudioDatabase, OpensWhatACrashLeft) {
    constexpr int count = 200;
    const auto crashed = options_.folder / "crashed";
    std::filesystem::create_directories(crashed);
    StudioStore store(options_.folder);
    const std::int64_t project = store.add_project("mug.glb");
    for (int i = 0; i < count; ++i)
        store.add_result(edit(project, "a golden mug"));
    // While the database is open, its newest pages are only in the log.
    for (const char* name : {"studio.sqlite", "studio.sqlite-wal"})
        std::filesystem::copy_file(options_.folder / name, crashed / name);
    EXPECT_EQ(StudioStore(crashed).results(project).size(), count);
}

TEST_F(StudioDatabase, KeepsProjectsAndResultsFromOneRunToTheNext) {
    std::int64_t project = 0, id = 0;
    {
        StudioStore store(options_.folder);
        project = store.add_project("mug.glb");
        store.set_model(project, "mug.glb", {{"triangles", 7}});
        StudioResult result = store.add_result(edit(project, "a golden mug"));
        id = result.id;
        EXPECT_EQ(result.state, ResultState::waiting);
        EXPECT_EQ(result.created.size(), std::string("2026-01-01T00:00:00Z").size());
        result.state = ResultState::failed;
        result.message = "no";
        result.seconds = 2.5;
        result.files = {"log.txt"};
        store.update_result(result);
        result.note = "mine";
        result.favourite = true;
        store.annotate_result(result);
        StudioResult child = edit(project, "a rusty mug");
        child.parent = id;
        EXPECT_EQ(store.add_result(child).parent, id);
    }
    StudioStore store(options_.folder);
    EXPECT_EQ(store.project(project)->model["triangles"], 7);
    EXPECT_EQ(store.project(project)->results, 2);
    const auto result = store.result(id);
    EXPECT_EQ(result->state, ResultState::failed);
    EXPECT_EQ(result->message, "no");
    EXPECT_EQ(result->seconds, 2.5);
    EXPECT_EQ(result->note, "mine");
    EXPECT_TRUE(result->favourite);
    EXPECT_EQ(result->files, std::vector<std::string>{"log.txt"});
    EXPECT_EQ(result->request["to"], "a golden mug");
    EXPECT_EQ(store.results_in(ResultState::waiting).size(), 1u);
    store.remove_result(id);
    EXPECT_FALSE(store.results(project).front().parent) << "a child of none";
    store.remove_project(project);
    EXPECT_TRUE(store.results(std::nullopt).empty());
}

TEST_F(StudioDatabase, ListsProjectsNewestFirst) {
    StudioStore store(options_.folder);
    for (int i = 0; i < 5; ++i)
        store.add_project(std::to_string(i));
    const auto newest = store.projects(2, 0);
    ASSERT_EQ(newest.size(), 2u);
    EXPECT_EQ(newest[0].name, "4");
    EXPECT_EQ(store.projects(2, newest[1].id).front().name, "2");
    store.mark_project(newest[0].id, true);
    store.rename_project(newest[0].id, "the mug");
    EXPECT_TRUE(store.project(newest[0].id)->favourite);
    EXPECT_EQ(store.project(newest[0].id)->name, "the mug");
}

TEST_F(StudioDatabase, RefusesLaterAndDamagedFiles) {
    const auto file = options_.folder / "studio.sqlite";
    {
        Sqlite database(file, true);
        database.run("PRAGMA user_version = 99");
    }
    EXPECT_THROW(StudioStore{options_.folder}, InputError);
    write(file, std::string(5000, 'x'));
    EXPECT_THROW(StudioStore{options_.folder}, InputError);
    EXPECT_EQ(read(file), std::string(5000, 'x')) << "left as it was";
}

}  // namespace
}  // namespace item3d::testing
