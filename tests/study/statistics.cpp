#include "item3d/study/statistics.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

// SciPy 1.17.1 gives the numbers of this file unless stated otherwise:
//
//   import numpy as np
//   from scipy import stats
//   b = np.array([[4,2,3,5],[3,3,2,4],[5,1,2,4],[4,2,2,3],[3,2,4,5],[5,3,3,4.]])
//   stats.friedmanchisquare(*b.T)
//   stats.wilcoxon([1.5,-0.25,2,0.75,-1,3,0.5,1.25], method='exact')
//   stats.wilcoxon([1,1,-1,2,2,3,-2,1,2],
//                  method=stats.PermutationMethod(n_resamples=np.inf))
//   stats.wilcoxon([(i*7%11-4)*0.5 for i in range(60)], method='approx', correction=False)
//   for x, f in ((0.5,1),(3.2,2),(9.1,3),(40,5)): stats.chi2.sf(x, f)
//   stats.bootstrap((np.array([3.1,4.2,2.8,3.9,4.4,3.3,2.5,4.0]),), np.mean, n_resamples=200000,
//                   method='percentile', random_state=1).confidence_interval

TEST(StudyStatistics, ChiSquareTail) {
    EXPECT_NEAR(chi_square_tail(0.5, 1), 0.47950012218695337, 1e-13);
    EXPECT_NEAR(chi_square_tail(3.2, 2), 0.2018965179946554, 1e-13);
    EXPECT_NEAR(chi_square_tail(9.1, 3), 0.027990457932157115, 1e-13);
    EXPECT_NEAR(chi_square_tail(40, 5) / 1.493367900050393e-07, 1, 1e-11);
    EXPECT_EQ(chi_square_tail(0, 3), 1);
}

TEST(StudyStatistics, FriedmanWithTies) {
    const auto result = friedman(
        {{4, 2, 3, 5}, {3, 3, 2, 4}, {5, 1, 2, 4}, {4, 2, 2, 3}, {3, 2, 4, 5}, {5, 3, 3, 4}});
    ASSERT_TRUE(result);
    EXPECT_NEAR(result->chi_square, 12.052631578947372, 1e-12);
    EXPECT_NEAR(result->p, 0.007205024448412267, 1e-13);
    EXPECT_NEAR(result->kendall_w, 12.052631578947372 / 18, 1e-12);
    EXPECT_FALSE(friedman({{3, 3, 3}, {2, 2, 2}}));
}

TEST(StudyStatistics, WilcoxonExact) {
    const Wilcoxon result = wilcoxon_signed_rank({1.5, -0.25, 2, 0.75, -1, 3, 0.5, 1.25});
    EXPECT_EQ(result.pairs, 8);
    EXPECT_EQ(result.statistic, 5);
    EXPECT_NEAR(result.p, 0.078125, 1e-14);
    EXPECT_NEAR(result.effect, (31.0 - 5) / 36, 1e-14);
}

TEST(StudyStatistics, WilcoxonExactWithTiesAndZeros) {
    const Wilcoxon result = wilcoxon_signed_rank({1, 1, -1, 2, 0, 2, 3, -2, 1, 2});
    EXPECT_EQ(result.pairs, 9);
    EXPECT_EQ(result.statistic, 9);
    EXPECT_NEAR(result.p, 0.140625, 1e-14);
    EXPECT_EQ(wilcoxon_signed_rank({0, 0}).p, 1);
}

TEST(StudyStatistics, WilcoxonByTheNormalApproximation) {
    std::vector<double> differences;
    for (int i = 0; i < 60; ++i)
        differences.push_back((i * 7 % 11 - 4) * 0.5);
    const Wilcoxon result = wilcoxon_signed_rank(differences);
    EXPECT_GT(result.pairs, 50);
    EXPECT_EQ(result.statistic, 495);
    EXPECT_NEAR(result.p, 0.020689043721346168, 1e-13);
}

// Holm's rule by hand: 0.01 * 4, 0.02 * 3, then 0.03 * 2, which is not below the preceding value,
// and 0.5.
TEST(StudyStatistics, HolmStepsDown) {
    const std::vector<double> adjusted = holm({0.03, 0.01, 0.5, 0.02});
    EXPECT_NEAR(adjusted[0], 0.06, 1e-15);
    EXPECT_NEAR(adjusted[1], 0.04, 1e-15);
    EXPECT_NEAR(adjusted[2], 0.5, 1e-15);
    EXPECT_NEAR(adjusted[3], 0.06, 1e-15);
}

// The quantiles of resamples vary: with 20,000 resamples, one standard error is about 0.005.
TEST(StudyStatistics, BootstrapInterval) {
    const std::vector<double> values{3.1, 4.2, 2.8, 3.9, 4.4, 3.3, 2.5, 4.0};
    const MeanInterval interval = bootstrap_mean(values, 20000, 1);
    EXPECT_NEAR(interval.mean, 3.525, 1e-12);
    EXPECT_NEAR(interval.low, 3.075, 0.026);
    EXPECT_NEAR(interval.high, 3.9625, 0.026);
    EXPECT_EQ(bootstrap_mean(values, 100, 1).low, bootstrap_mean(values, 100, 1).low);
}

// The ratings are those of Krippendorff's "Computing Krippendorff's Alpha-Reliability" (2011),
// section C. The package krippendorff 0.9.0 gives the number:
//
//   n = numpy.nan
//   krippendorff.alpha(reliability_data=[[1,2,3,3,2,1,4,1,2,n,n,n], [1,2,3,3,2,2,4,1,2,5,n,3],
//                                        [n,3,3,3,2,3,4,2,2,5,1,n], [1,2,3,3,2,4,4,1,2,5,1,n]],
//                      level_of_measurement='ordinal')
TEST(StudyStatistics, KrippendorffsExample) {
    const std::optional<int> none;
    const std::vector<std::vector<std::optional<int>>> ratings = {
        {1, 2, 3, 3, 2, 1, 4, 1, 2, none, none, none},
        {1, 2, 3, 3, 2, 2, 4, 1, 2, 5, none, 3},
        {none, 3, 3, 3, 2, 3, 4, 2, 2, 5, 1, none},
        {1, 2, 3, 3, 2, 4, 4, 1, 2, 5, 1, none}};
    const auto alpha = krippendorff_alpha(ratings);
    ASSERT_TRUE(alpha);
    EXPECT_NEAR(*alpha, 0.8153875037548814, 1e-12);
    EXPECT_FALSE(krippendorff_alpha({{3, 3}, {3, 3}}));
}

}  // namespace
}  // namespace item3d
