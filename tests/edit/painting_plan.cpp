// Tests of the detail stage's painting plan, on a cube.
#include "item3d/edit/detail/painting_plan.h"

#include "tests/support/edit.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

using testing::EditTest;

double fresh_share(const PaintingView& view) {
    return 1 - view.known.mean().item<double>();
}

TEST_F(EditTest, LaterPaintingViewsLeaveWhatEarlierOnesPainted) {
    const EditRequest edit = request("out", 1, {{"resolution", 64}});
    const EditScene scene = load_scene(edit);
    const std::vector<PaintingView> plan = plan_painting(scene, edit.plan);
    ASSERT_EQ(plan.size(), 20u);
    const auto pixels = [](const at::Tensor& cells) {
        return at::upsample_nearest2d(cells, {64, 64});
    };
    // The first view owns all cells that it sees, except cells of which it covers little. The
    // background has no owner.
    EXPECT_LT((pixels(plan[0].known) * plan[0].facing).sum().item<float>(),
              0.05f * plan[0].facing.sum().item<float>());
    EXPECT_EQ(plan[0].known[0][0][0][0].item<float>(), 1);
    EXPECT_GT(fresh_share(plan[0]), 0.2);
    double last = 0;
    for (std::size_t i = 5; i < 8; ++i)
        last += fresh_share(plan[i]) / 3;
    EXPECT_LT(last, 0.3 * fresh_share(plan[0]));
    EXPECT_EQ(plan[7].round, PaintingRound::initial);
    // Each round paints the whole model again.
    EXPECT_EQ(plan[8].round, PaintingRound::refine);
    EXPECT_EQ(plan[13].first_of_round, 8);
    EXPECT_GT(fresh_share(plan[8]), 0.2);
    EXPECT_EQ(plan[14].round, PaintingRound::close_up);
    EXPECT_EQ(plan[14].first_of_round, 14);
    EXPECT_GT(fresh_share(plan[14]), 0.2);
    EXPECT_TRUE(plan_painting(scene, edit.plan)[19].known.equal(plan[19].known));
}

}  // namespace
}  // namespace item3d
