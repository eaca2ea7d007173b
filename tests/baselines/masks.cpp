// Tests of TEXTure's trimap and Text2Tex's masks against plain loops, of the choice of views, and
// of their weights.
#include "item3d/baselines/sync_mvd.h"
#include "item3d/baselines/text2tex_views.h"
#include "item3d/baselines/texture_painter.h"
#include "item3d/baselines/trimap.h"
#include "item3d/baselines/view_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace item3d::testing {
namespace {

constexpr int mask_side = 240;  ///< side of the images; a fifth of the published 1200

/// Square image of mask_side x mask_side pixels, stored row by row.
struct Plain {
    std::vector<float> values = std::vector<float>(mask_side * mask_side);

    Plain() = default;
    explicit Plain(const at::Tensor& mask) {
        const at::Tensor flat = mask.contiguous().flatten();
        values.assign(flat.const_data_ptr<float>(), flat.const_data_ptr<float>() + flat.numel());
    }
    float& at(int x, int y) { return values[static_cast<std::size_t>(y * mask_side + x)]; }
    /// Returns the maximum over the square of `width` pixels around (x, y); pixels beyond the image
    /// count as `outside`.
    float largest(int x, int y, int width, float outside) {
        float found = -1;
        for (int dy = -width / 2; dy <= width / 2; ++dy)
            for (int dx = -width / 2; dx <= width / 2; ++dx) {
                const int nx = x + dx, ny = y + dy;
                const bool inside = nx >= 0 && ny >= 0 && nx < mask_side && ny < mask_side;
                found = std::max(found, inside ? at(nx, ny) : outside);
            }
        return found;
    }
    Plain dilated(int width) {
        Plain result;
        for (int y = 0; y < mask_side; ++y)
            for (int x = 0; x < mask_side; ++x)
                result.at(x, y) = largest(x, y, width, 0);
        return result;
    }
    Plain inverse() {
        Plain result;
        for (std::size_t i = 0; i < values.size(); ++i)
            result.values[i] = 1 - values[i];
        return result;
    }
    Plain eroded(int width) { return inverse().dilated(width).inverse(); }
};

/// Returns the inputs for a model that appears as a disk. Its left third was painted at a flat
/// angle, the middle nearly from the front, and the right third is unpainted.
TrimapInput disk() {
    const at::Tensor x = at::arange(mask_side, at::kFloat).view({1, 1, 1, -1});
    const at::Tensor y = at::arange(mask_side, at::kFloat).view({1, 1, -1, 1});
    const at::Tensor distance = ((x - 120).square() + (y - 120).square()).sqrt();
    TrimapInput input;
    input.covered = (distance < 90).to(at::kFloat);
    input.editable = input.covered * (y > 60);
    input.cosine = (1 - (distance / 90).square()).clamp_min(0).sqrt() * input.covered;
    input.best = at::where(x < 90, 0.25, at::where(x < 150, 0.9, 0.0)) * input.covered;
    input.unpainted = (input.best == 0).to(at::kFloat) * input.covered;
    return input;
}

TEST(Trimap, IsWhatPlainLoopsFind) {
    const TrimapInput input = disk();
    const Trimap map = make_trimap(input);
    Plain covered(input.covered), editable(input.editable), unpainted(input.unpainted),
        cosine(input.cosine), best(input.best);
    const int generation = scaled_width(19, mask_side), opening = scaled_width(5, mask_side),
              border = scaled_width(7, mask_side);
    EXPECT_EQ(generation, 3);  // 3.8 pixels, rounded down
    Plain waiting, better;
    for (int y = 0; y < mask_side; ++y)
        for (int x = 0; x < mask_side; ++x) {
            waiting.at(x, y) = unpainted.at(x, y) * editable.at(x, y);
            better.at(x, y) = editable.at(x, y) > 0 && best.at(x, y) > 0 &&
                              cosine.at(x, y) > best.at(x, y) + 0.2f;
        }
    Plain generate = waiting.dilated(generation), refine = better.eroded(opening).dilated(opening),
          inner = covered.eroded(border);
    Plain got_generate(map.generate), got_refine(map.refine), got_keep(map.keep),
        got_update(map.update);
    int wrong = 0, counts[3] = {};
    for (int y = 0; y < mask_side; ++y)
        for (int x = 0; x < mask_side; ++x) {
            const float e = editable.at(x, y), g = generate.at(x, y) * e,
                        r = refine.at(x, y) * e * (1 - g), k = e * (1 - g) * (1 - r);
            const float u = std::max(g, r) * (inner.at(x, y) > 0 || g > 0 ? 1 : 0);
            wrong += got_generate.at(x, y) != g || got_refine.at(x, y) != r ||
                     got_keep.at(x, y) != k || got_update.at(x, y) != u;
            counts[0] += g > 0;
            counts[1] += r > 0;
            counts[2] += k > 0;
        }
    EXPECT_EQ(wrong, 0);
    for (const int count : counts)
        EXPECT_GT(count, 100);
}

TEST(Trimap, ProjectionKeepsOffTheOutlineAndOffWhatIsSeenBetterElsewhere) {
    const TrimapInput input = disk();
    const at::Tensor mask = projection_mask(input, make_trimap(input).update);
    Plain plain(mask), covered(input.covered), cosine(input.cosine), best(input.best);
    Plain inner = covered.eroded(scaled_width(5, mask_side));
    int used = 0;
    for (int y = 0; y < mask_side; ++y)
        for (int x = 0; x < mask_side; ++x) {
            const float value = plain.at(x, y);
            EXPECT_TRUE(value == 0 || (value >= 0.5f && value <= 1.0001f)) << value;
            if (value == 0) continue;
            ++used;
            EXPECT_GT(inner.at(x, y), 0);
            EXPECT_GE(cosine.at(x, y) + 0.2001f, best.at(x, y));
        }
    EXPECT_GT(used, 1000);
}

TEST(Trimap, RefinedCellsTakeTurnsInTheFirstHalfOfTheSteps) {
    Trimap map;
    map.generate = at::zeros({1, 1, 64, 64});
    map.generate.narrow(3, 0, 16).fill_(1);
    map.refine = at::zeros({1, 1, 64, 64});
    map.refine.narrow(3, 16, 48).fill_(1);
    map.update = at::ones({1, 1, 64, 64});
    const at::Tensor early = drawn_cells(map, 16, 16, 0, 10);
    const at::Tensor late = drawn_cells(map, 16, 16, 5, 10);
    EXPECT_TRUE(late.equal(at::ones({1, 1, 16, 16})));
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            EXPECT_EQ(early[0][0][y][x].item<float>(), x < 4 || (x / 2 + y / 2) % 2 == 1);
}

TEST(Text2TexViews, MasksDivideWhatIsSeen) {
    const at::Tensor ones = at::ones({1, 1, 8, 8});
    GenerationInput input{ones, at::zeros({1, 1, 8, 8}), 0.8 * ones, 0.8 * ones};
    input.painted.narrow(3, 2, 6).fill_(1);
    input.best.narrow(3, 5, 3).fill_(0.95);
    input.cosine.narrow(2, 7, 1).fill_(0.05);  // at too flat an angle
    const GenerationMask mask = make_generation_mask(input);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            const auto at = [&](const at::Tensor& of) { return of[0][0][y][x].item<float>(); };
            EXPECT_EQ(at(mask.fresh), y < 7 && x < 2) << x << " " << y;
            EXPECT_EQ(at(mask.update), y < 7 && x >= 2 && x < 5);
            EXPECT_EQ(at(mask.keep), y < 7 && x >= 5);
        }
    EXPECT_NEAR(view_heat(mask), (14 * 1 + 21 * 0.5 + 21 * 0.1) / 64, 1e-6);
}

TEST(Text2TexViews, TakesTheHottestAndSeldomTwice) {
    EXPECT_EQ(choose_view({0.1, 0.5, 0.3}, {false, false, false}), 1u);
    EXPECT_EQ(choose_view({0.1, 0.5, 0.3}, {false, true, false}), 2u);
    EXPECT_EQ(choose_view({0.001, 0.5, 0.001}, {false, true, false}), 1u);
    EXPECT_EQ(choose_view({0.2, 0.2}, {false, false}), 0u);
}

TEST(ViewLists, AreAsPublished) {
    ASSERT_EQ(ring_and_poles().size(), 10u);
    EXPECT_EQ(ring_and_poles()[2].azimuth, 315);
    EXPECT_EQ(principal_views().size(), 10u);
    EXPECT_EQ(candidate_views().size(), 36u);
    EXPECT_EQ(synchronized_views().size(), 10u);
    EXPECT_EQ(first_views(candidate_views(), 3).size(), 3u);
    EXPECT_EQ(first_views(candidate_views(), 0).size(), 36u);
    EXPECT_EQ(side_of({0, 30}), "front");
    EXPECT_EQ(side_of({315, 30}), "left");
    EXPECT_EQ(side_of({90, 30}), "right");
    EXPECT_EQ(side_of({180, 0}), "back");
    EXPECT_EQ(side_of({180, 60}), "overhead");
    EXPECT_EQ(side_of({0, -60}), "bottom");
}

TEST(SyncMvd, ViewsCountByTheirCosineAndMoreSharplyAtTheEnd) {
    const at::Tensor cosine = at::tensor({0.0f, 0.5f, 1.0f});
    const at::Tensor first = view_weight(cosine, 0, 31), last = view_weight(cosine, 30, 31);
    EXPECT_EQ(first[0].item<float>(), 0);  // not seen, for any exponent
    EXPECT_EQ(first[1].item<float>(), 1);
    EXPECT_NEAR(last[1].item<float>(), std::pow(0.5, 6), 1e-6);
    EXPECT_EQ(last[2].item<float>(), 1);
    const MergedTexels merged =
        merge_views({at::full({3, 1}, 2.0f), at::full({3, 1}, 4.0f)},
                    {at::tensor({1.0f, 0.0f, 0.0f}), at::tensor({3.0f, 1.0f, 0.0f})});
    EXPECT_NEAR(merged.values[0][0].item<float>(), (2 + 3 * 4) / 4.0, 1e-6);
    EXPECT_NEAR(merged.values[1][0].item<float>(), 4, 1e-6);
    EXPECT_TRUE(merged.known[1].item<bool>());
    EXPECT_FALSE(merged.known[2].item<bool>());
}

}  // namespace
}  // namespace item3d::testing
