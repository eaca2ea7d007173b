// Statistics of ratings: intervals, tests between methods, agreement between raters.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace item3d {

/// A mean with a percentile bootstrap interval (Efron 1979).
struct MeanInterval {
    double mean = 0;
    double low = 0;   ///< 2.5 % quantile of the resampled means
    double high = 0;  ///< 97.5 % quantile
};

/// Resamples `values` with replacement `resamples` times. One value: an interval of no width.
/// values: at least one.
MeanInterval bootstrap_mean(const std::vector<double>& values, int resamples, std::uint64_t seed);

/// Result of a Friedman test, with the correction for ties.
struct Friedman {
    double chi_square = 0;  ///< with methods - 1 degrees of freedom
    double p = 1;           ///< upper tail of the chi-square distribution
    double kendall_w = 0;   ///< agreement of the blocks' rankings, 0 to 1
};

/// blocks: [raters][methods], at least two raters and three methods. Nothing when every rater gave
/// all methods one value, for which the statistic is 0 / 0.
std::optional<Friedman> friedman(const std::vector<std::vector<double>>& blocks);

/// Result of a two-sided Wilcoxon signed-rank test of paired differences.
struct Wilcoxon {
    int pairs = 0;         ///< differences that are not zero, which are dropped (Wilcoxon's rule)
    double statistic = 0;  ///< the smaller of the sums of positive and negative ranks
    double p = 1;
    double effect = 0;  ///< rank-biserial correlation, -1 to 1; above 0: differences above 0
};

/// Exact over all signs of the ranks, tied ranks included, up to 50 pairs; above that the normal
/// approximation with the correction for ties and none for continuity.
Wilcoxon wilcoxon_signed_rank(const std::vector<double>& differences);

/// Holm's step-down adjustment (1979) of p values, in their order.
std::vector<double> holm(const std::vector<double>& p);

/// Krippendorff's alpha for ordinal ratings. ratings: [raters][units]; nothing where a rater did
/// not rate. 1: full agreement, 0: as by chance. Nothing when no unit has two ratings or all
/// ratings are one value.
std::optional<double> krippendorff_alpha(
    const std::vector<std::vector<std::optional<int>>>& ratings);

/// Mean ranks from 1 of values in ascending order; ties share the mean of their ranks.
std::vector<double> mean_ranks(const std::vector<double>& values);

/// Upper tail of the chi-square distribution: P(X > x) for `freedom` degrees, at least one.
double chi_square_tail(double x, int freedom);

}  // namespace item3d
