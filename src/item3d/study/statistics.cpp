#include "item3d/study/statistics.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace item3d {
namespace {

/// Returns a quantile, interpolated linearly between order statistics as NumPy does by default.
double quantile(const std::vector<double>& sorted, double share) {
    const double place = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

/// Returns the sum of t^3 - t over groups of t equal values.
double tie_term(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    double sum = 0;
    for (std::size_t begin = 0; begin < values.size();) {
        std::size_t end = begin;
        while (end < values.size() && values[end] == values[begin])
            ++end;
        const auto t = static_cast<double>(end - begin);
        sum += t * t * t - t;
        begin = end;
    }
    return sum;
}

/// Returns the two-sided p over all 2^n signs. Mean ranks are multiples of one half, so twice the
/// sum of the positive ranks is an integer, and its distribution is a convolution.
double exact_p(const std::vector<double>& ranks, double positive) {
    std::vector<double> chance{1.0};
    for (const double rank : ranks) {
        const auto step = static_cast<std::size_t>(std::lround(2 * rank));
        std::vector<double> next(chance.size() + step, 0.0);
        for (std::size_t sum = 0; sum < chance.size(); ++sum) {
            next[sum] += 0.5 * chance[sum];
            next[sum + step] += 0.5 * chance[sum];
        }
        chance = std::move(next);
    }
    const auto seen = std::lround(2 * positive);
    const auto at = chance.begin() + seen;
    const double lower = std::accumulate(chance.begin(), at + 1, 0.0);
    const double upper = std::accumulate(at, chance.end(), 0.0);
    return std::min(1.0, 2 * std::min(lower, upper));
}

double normal_p(const std::vector<double>& ranks, double statistic) {
    const auto n = static_cast<double>(ranks.size());
    const double mean = n * (n + 1) / 4;
    const double variance = n * (n + 1) * (2 * n + 1) / 24 - tie_term(ranks) / 48;
    return std::min(1.0, std::erfc(std::abs(statistic - mean) / std::sqrt(2 * variance)));
}

}  // namespace

MeanInterval bootstrap_mean(const std::vector<double>& values, int resamples, std::uint64_t seed) {
    ITEM3D_CHECK(!values.empty() && resamples > 0, "a bootstrap of nothing");
    const auto count = static_cast<std::int64_t>(values.size());
    const auto n = static_cast<double>(count);
    Random random(seed, RandomStream::study_bootstrap);
    std::vector<double> means;
    for (int resample = 0; resample < resamples; ++resample) {
        double sum = 0;
        for (std::int64_t i = 0; i < count; ++i)
            sum += values[static_cast<std::size_t>(random.index(count))];
        means.push_back(sum / n);
    }
    std::sort(means.begin(), means.end());
    return {std::accumulate(values.begin(), values.end(), 0.0) / n, quantile(means, 0.025),
            quantile(means, 0.975)};
}

std::vector<double> mean_ranks(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    std::vector<double> ranks(values.size());
    for (std::size_t begin = 0; begin < order.size();) {
        std::size_t end = begin;
        while (end < order.size() && values[order[end]] == values[order[begin]])
            ++end;
        for (std::size_t i = begin; i < end; ++i)
            ranks[order[i]] = static_cast<double>(begin + 1 + end) / 2;
        begin = end;
    }
    return ranks;
}

/// Uses the series below freedom + 2, and the continued fraction (Lentz) above (Press et al.,
/// Numerical Recipes 6.2).
double chi_square_tail(double x, int freedom) {
    ITEM3D_CHECK(freedom >= 1, "chi-square without degrees of freedom");
    if (!(x > 0)) return 1;
    const double a = freedom / 2.0, z = x / 2;
    const double front = std::exp(a * std::log(z) - z - std::lgamma(a));
    if (z < a + 1) {
        double term = 1 / a, sum = term;
        for (double k = 1; term > sum * 1e-17; ++k)
            sum += term *= z / (a + k);
        return std::max(0.0, 1 - front * sum);
    }
    double b = z + 1 - a, c = 1e300, d = 1 / b, fraction = d;
    for (int k = 1; k < 10000; ++k) {
        const double factor = -k * (k - a);
        b += 2;
        d = 1 / (factor * d + b);
        c = b + factor / c;
        fraction *= c * d;
        if (std::abs(c * d - 1) < 1e-16) break;
    }
    return front * fraction;
}

std::optional<Friedman> friedman(const std::vector<std::vector<double>>& blocks) {
    const std::size_t methods = blocks.empty() ? 0 : blocks.front().size();
    ITEM3D_CHECK(blocks.size() >= 2 && methods >= 3, "too few for a Friedman test");
    const auto n = static_cast<double>(blocks.size()), k = static_cast<double>(methods);
    std::vector<double> sums(methods, 0.0);
    double ties = 0;
    for (const std::vector<double>& block : blocks) {
        const std::vector<double> ranks = mean_ranks(block);
        for (std::size_t method = 0; method < methods; ++method)
            sums[method] += ranks[method];
        ties += tie_term(ranks);
    }
    const double correction = 1 - ties / (n * k * (k * k - 1));
    if (correction <= 1e-12) return std::nullopt;
    double squares = 0;
    for (const double sum : sums)
        squares += sum * sum;
    Friedman result;
    result.chi_square = (12 / (n * k * (k + 1)) * squares - 3 * n * (k + 1)) / correction;
    result.p = chi_square_tail(result.chi_square, static_cast<int>(methods) - 1);
    result.kendall_w = result.chi_square / (n * (k - 1));
    return result;
}

Wilcoxon wilcoxon_signed_rank(const std::vector<double>& differences) {
    std::vector<double> kept, sizes;
    for (const double difference : differences) {
        // The differences are between means of integers. Equal differences may differ in their last
        // bits.
        const double rounded = std::round(difference * 1e9) / 1e9;
        if (rounded == 0) continue;
        kept.push_back(rounded);
        sizes.push_back(std::abs(rounded));
    }
    Wilcoxon result;
    result.pairs = static_cast<int>(kept.size());
    if (kept.empty()) return result;
    const std::vector<double> ranks = mean_ranks(sizes);
    double positive = 0, all = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        all += ranks[i];
        if (kept[i] > 0) positive += ranks[i];
    }
    result.statistic = std::min(positive, all - positive);
    result.effect = (2 * positive - all) / all;
    result.p = kept.size() <= 50 ? exact_p(ranks, positive) : normal_p(ranks, result.statistic);
    return result;
}

std::vector<double> holm(const std::vector<double>& p) {
    std::vector<std::size_t> order(p.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
    std::vector<double> adjusted(p.size());
    double greatest = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        greatest = std::max(greatest, p[order[i]] * static_cast<double>(p.size() - i));
        adjusted[order[i]] = std::min(1.0, greatest);
    }
    return adjusted;
}

/// Uses the coincidence matrix and the ordinal metric of Krippendorff, "Computing Krippendorff's
/// Alpha-Reliability" (2011).
std::optional<double> krippendorff_alpha(
    const std::vector<std::vector<std::optional<int>>>& ratings) {
    std::map<int, std::map<int, double>> coincidences;
    std::map<int, double> totals;
    double pairable = 0;
    const std::size_t units = ratings.empty() ? 0 : ratings.front().size();
    for (std::size_t unit = 0; unit < units; ++unit) {
        std::map<int, double> counts;
        double given = 0;
        for (const auto& rater : ratings) {
            if (!rater[unit]) continue;
            ++counts[*rater[unit]];
            ++given;
        }
        if (given < 2) continue;
        pairable += given;
        for (const auto& [a, count_a] : counts) {
            totals[a] += count_a;
            for (const auto& [b, count_b] : counts)
                coincidences[a][b] += count_a * (a == b ? count_b - 1 : count_b) / (given - 1);
        }
    }
    if (totals.size() < 2) return std::nullopt;
    const auto distance = [&](int a, int b) {  // a < b
        double between = 0;
        for (auto at = totals.find(a); at != totals.end() && at->first <= b; ++at)
            between += at->second;
        between -= (totals.at(a) + totals.at(b)) / 2;
        return between * between;
    };
    double observed = 0, expected = 0;
    for (auto a = totals.begin(); a != totals.end(); ++a) {
        for (auto b = std::next(a); b != totals.end(); ++b) {
            const double metric = distance(a->first, b->first);
            observed += coincidences[a->first][b->first] * metric;
            expected += a->second * b->second * metric;
        }
    }
    return 1 - (pairable - 1) * observed / expected;
}

}  // namespace item3d
