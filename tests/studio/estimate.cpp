// Tests of estimated times, with and without earlier edits on this machine.
#include "item3d/studio/estimate.h"

#include <gtest/gtest.h>

namespace item3d::testing {
namespace {

using Json = nlohmann::json;

const Json defaults = {{"iterations", 100},
                       {"iterations_before_detail", 50},
                       {"batch", 1},
                       {"resolution", 64},
                       {"detail_words", {"rusty"}}};
const Json request = {{"from", "a red mug"}, {"to", "a golden mug"}};

double seconds(const Json& wanted, const std::vector<EditCost>& former, int threads = 2) {
    return estimate_edit(wanted, defaults, former, threads)["seconds"];
}

TEST(StudioEstimate, FollowsEditsOnThisMachine) {
    const EditCost cost{100, 64 * 64, 20, 0, 2, 3, 1e9};
    EXPECT_EQ(seconds(request, {cost}), 25);
    Json more = request;
    more["settings"] = {{"iterations", 200}, {"batch", 2}};
    EXPECT_EQ(seconds(more, {cost}), 4 * 20 + 5);
    EXPECT_EQ(seconds(request, {{100, 64 * 64, 1000, 0, 2, 3, 1e9}, cost, cost}), 25)
        << "the median";
    const Json whole = estimate_edit(request, defaults, {cost}, 2);
    EXPECT_EQ(whole["memory_bytes"], 1e9);
    EXPECT_EQ(whole["basis"], "edits on this machine");
}

TEST(StudioEstimate, KnowsWhenDetailFollows) {
    const EditCost cost{50, 64 * 64, 10, 8, 2, 3, 1e9};
    Json rusty = request;
    rusty["to"] = "a rusty mug";
    EXPECT_EQ(seconds(rusty, {cost}), 10 + 8 + 5);
    rusty["settings"] = {{"detail", "off"}};
    EXPECT_EQ(seconds(rusty, {cost}), 20 + 5) << "with all iterations";
}

TEST(StudioEstimate, IsThereBeforeTheFirstEdit) {
    EXPECT_GT(seconds(request, {}), 5);
    EXPECT_NEAR(seconds(request, {}, 4), seconds(request, {}, 2) / 2, 0.1);
}

TEST(StudioEstimate, ReadsSummaries) {
    Json summary = {
        {"iterations_done", 100},
        {"settings", {{"batch", 2}, {"resolution", 64}}},
        {"seconds", {{"load", 1}, {"fit", 2}, {"optimize", 20}, {"total", 31}, {"detail", 6}}},
        {"peak_memory_bytes", 1e9},
        {"command", "item3d edit mug.glb"}};
    const auto cost = edit_cost(summary);
    ASSERT_TRUE(cost);
    EXPECT_EQ(cost->pixels, 2 * 64 * 64);
    EXPECT_EQ(cost->before, 3);
    EXPECT_EQ(cost->after, 2);
    summary["command"] = "item3d edit mug.glb --resume";
    EXPECT_FALSE(edit_cost(summary));
    EXPECT_FALSE(edit_cost(Json::object()));
}

}  // namespace
}  // namespace item3d::testing
