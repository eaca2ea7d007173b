// Statistics of ratings: confidence intervals, tests between methods, and agreement between raters.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace item3d {

/// Mean with a percentile bootstrap interval (Efron 1979).
struct MeanInterval {
    double mean = 0;
    double low = 0;   ///< 2.5 % quantile of the resampled means
    double high = 0;  ///< 97.5 % quantile
};

/// Resamples `values` with replacement `resamples` times. There must be at least one value. A
/// single value gives an interval of width 0.
MeanInterval bootstrap_mean(const std::vector<double>& values, int resamples, std::uint64_t seed);

/// Result of a Friedman test, with the correction for ties.
struct Friedman {
    double chi_square = 0;  ///< statistic with methods - 1 degrees of freedom
    double p = 1;           ///< upper tail of the chi-square distribution
    double kendall_w = 0;   ///< agreement of the blocks' rankings, 0 to 1
};

/// Computes the test of blocks [raters][methods]. There must be at least two raters and three
/// methods. Returns nullopt if every rater gave all methods the same value, because the statistic
/// is then 0 / 0.
std::optional<Friedman> friedman(const std::vector<std::vector<double>>& blocks);

/// Result of a two-sided Wilcoxon signed-rank test of paired differences.
struct Wilcoxon {
    int pairs = 0;         ///< number of non-zero differences; zeros are dropped (Wilcoxon's rule)
    double statistic = 0;  ///< the smaller of the sums of positive and negative ranks
    double p = 1;
    /// Rank-biserial correlation, -1 to 1. It is positive if positive differences dominate.
    double effect = 0;
};

/// Computes the test. Up to 50 pairs it is exact over all signs of the ranks, tied ranks included.
/// Above 50 pairs it uses the normal approximation, with tie correction and without continuity
/// correction.
Wilcoxon wilcoxon_signed_rank(const std::vector<double>& differences);

/// Returns Holm's step-down adjustment (1979) of p values, in their order.
std::vector<double> holm(const std::vector<double>& p);

/// Returns Krippendorff's alpha for ordinal ratings. ratings: [raters][units]; nullopt for a
/// missing rating. The result is 1 for full agreement, and 0 for agreement as by chance. It is
/// nullopt if no unit has two ratings, or if all ratings have the same value.
std::optional<double> krippendorff_alpha(
    const std::vector<std::vector<std::optional<int>>>& ratings);

/// Returns ranks from 1 of values in ascending order; ties share the mean of their ranks.
std::vector<double> mean_ranks(const std::vector<double>& values);

/// Returns the upper tail P(X > x) of the chi-square distribution. freedom: degrees of freedom, at
/// least one.
double chi_square_tail(double x, int freedom);

}  // namespace item3d
