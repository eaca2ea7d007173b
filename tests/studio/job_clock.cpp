// Tests of the remaining time of an edit, which is estimated from its stages.
#include "item3d/studio/job_clock.h"

#include <gtest/gtest.h>

namespace item3d::testing {
namespace {

using Json = nlohmann::json;

Json stage(const std::string& name, int done = 0, int total = 0, Json left = nullptr) {
    return {{"stage", name}, {"done", done}, {"total", total}, {"seconds_left", std::move(left)}};
}

const EditPlanSeconds plan{.before = 2, .optimize = 20, .detail = 10, .after = 8};

TEST(StudioJobClock, AddsTheStagesThatCome) {
    JobClock clock(plan);
    EXPECT_EQ(clock.seconds_left(stage("load"), 0.5), 39.5);
    EXPECT_EQ(clock.seconds_left(stage("fit", 100, 200, 1.5), 1), 1.5 + 38);
    EXPECT_EQ(clock.seconds_left(stage("edit", 50, 100, 10), 12), 10 + 18);
    EXPECT_EQ(clock.seconds_left(stage("detail", 1, 9, 9), 23), 9 + 8);
}

TEST(StudioJobClock, TakesThePaceOfThisRun) {
    JobClock clock(plan);
    EXPECT_EQ(clock.seconds_left(stage("edit", 50, 100, 20), 22), 20 + 2 * 18) << "half as fast";
    EXPECT_EQ(clock.seconds_left(stage("detail", 5, 10, 10), 50), 10 + 2 * 8);
    JobClock early(plan);
    EXPECT_EQ(early.seconds_left(stage("edit", 1, 100, 500), 3), 500 + 18) << "too early to tell";
}

TEST(StudioJobClock, RunsDownWhereAStageSaysNothing) {
    JobClock clock(plan);
    EXPECT_EQ(clock.seconds_left(stage("edit", 100, 100, 0), 30), 18);
    EXPECT_EQ(clock.seconds_left(stage("bake"), 33), 15);
    EXPECT_EQ(clock.seconds_left(stage("report"), 40), 8);
    EXPECT_EQ(clock.seconds_left(stage("report"), 70), 1) << "never nothing while it runs";
}

TEST(StudioJobClock, SaysNothingWithoutAPlan) {
    EXPECT_FALSE(JobClock().seconds_left(stage("surface", 1, 2, 1), 1));
}

}  // namespace
}  // namespace item3d::testing
