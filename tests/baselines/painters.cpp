// Tests of the painters on a sphere, with a prior of random weights: their rows, their output, and
// equal numbers after resuming.
#include "item3d/baselines/methods.h"
#include "tests/support/baselines.h"

#include <gtest/gtest.h>

namespace item3d::testing {
namespace {

struct Painted {
    at::Tensor colors;
    std::int64_t rows;
};

/// `stop` is the number of steps after which the painter is recreated from its state; 0 means
/// never.
Painted paint(SphereScene& sphere, const std::string& method, const PainterOptions& options,
              std::int64_t stop = 0) {
    const std::int64_t before = sphere.scene.prior->predicted_rows();
    auto painter = make_painter(method, sphere.scene, options);
    for (std::int64_t i = 0; i < painter_steps(method, options); ++i) {
        if (stop > 0 && i == stop) {
            const NamedTensors state = painter->state();
            painter = make_painter(method, sphere.scene, options);
            painter->load_state(CheckpointReader("state", state));
        }
        painter->step(i);
    }
    painter->finish();
    return {painter->colors(), sphere.scene.prior->predicted_rows() - before};
}

TEST(Painters, AskTheUNetAsOftenAsTheyArePublishedTo) {
    SphereScene sphere(32);
    sphere.load_prior();
    PainterOptions options{.steps = 3, .views = 2, .cfg = 7.5f, .seed = 1};
    // Each step takes two rows for guidance. PNDM takes one step more.
    EXPECT_EQ(paint(sphere, "controlnet-2d", options).rows, 2 * 3 * 2);
    EXPECT_EQ(paint(sphere, "texture", options).rows, 2 * (3 + 1) * 2);
    EXPECT_EQ(paint(sphere, "syncmvd", options).rows, 2 * 3 * 2);
    // One view takes part in each of the 3 steps. Where the second view may update the first, it
    // takes one step more (0.3 of 3, rounded).
    const std::int64_t rows = paint(sphere, "text2tex", options).rows;
    EXPECT_GE(rows, 2 * 3 * 2);
    EXPECT_LE(rows, 2 * 3 * 2 + 2 * 1 * 2);
    EXPECT_EQ(painter_steps("texture", {}), 10);
    EXPECT_EQ(painter_steps("controlnet-2d", {}), 10);
    EXPECT_EQ(painter_steps("text2tex", {}), 10 + 20);
    EXPECT_EQ(painter_steps("syncmvd", {}), 30);
}

class EachPainter : public ::testing::TestWithParam<const char*> {};

TEST_P(EachPainter, PaintsAllTexelsAndLeavesThoseOutsideOfTheRegion) {
    SphereScene sphere(32);
    sphere.load_prior();
    const at::Tensor left = sphere.scene.texels->surface().uv.select(1, 0) < 0.5;
    sphere.scene.weight = left.to(at::kFloat).unsqueeze(1);
    const PainterOptions options{.steps = 3, .views = 2, .cfg = 3, .seed = 2};
    const Painted whole = paint(sphere, GetParam(), options);
    EXPECT_TRUE(at::isfinite(whole.colors).all().item<bool>());
    EXPECT_GE(whole.colors.min().item<float>(), -1e-4f);
    EXPECT_LE(whole.colors.max().item<float>(), 1.0001f);
    const at::Tensor changed = (whole.colors - sphere.scene.source).abs().sum(1) > 1e-3;
    EXPECT_FALSE((changed & left.logical_not()).any().item<bool>());
    EXPECT_GT((changed & left).sum().item<float>(), 0.9f * left.sum().item<float>());

    EXPECT_TRUE(paint(sphere, GetParam(), options, 1).colors.equal(whole.colors)) << "resumed";
    PainterOptions other = options;
    other.seed = 3;
    EXPECT_FALSE(paint(sphere, GetParam(), other).colors.equal(whole.colors)) << "another seed";
}

INSTANTIATE_TEST_SUITE_P(Methods, EachPainter,
                         ::testing::Values("controlnet-2d", "texture", "text2tex", "syncmvd"));

TEST(Methods, AreListedWithWhatTheyCost) {
    for (const EditMethod& method : edit_methods()) {
        EXPECT_FALSE(method.description.empty());
        EXPECT_FALSE(method.cost.empty());
        EXPECT_TRUE(method_settings(method.name).is_object());
    }
    EXPECT_EQ(edit_method_names().front(), "item3d");
    EXPECT_TRUE(paints_views("texture"));
    EXPECT_FALSE(paints_views("sds"));
}

}  // namespace
}  // namespace item3d::testing
