#include "item3d/networks/diffusion/samplers/sigmas.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

/// Returns the fractional timestep of a sigma.
double timestep_of(const std::vector<double>& sigmas, double sigma) {
    const auto above = std::upper_bound(sigmas.begin(), sigmas.end(), sigma);
    const auto last = static_cast<std::ptrdiff_t>(sigmas.size()) - 2;
    const auto low = std::clamp<std::ptrdiff_t>(above - sigmas.begin() - 1, 0,
                                                std::max<std::ptrdiff_t>(last, 0));
    const auto high = std::min<std::ptrdiff_t>(low + 1, last + 1);
    const double below = std::log(sigmas[static_cast<std::size_t>(low)]);
    const double span = std::log(sigmas[static_cast<std::size_t>(high)]) - below;
    const double part = span > 0 ? (std::log(sigma) - below) / span : 0;
    return static_cast<double>(low) + std::clamp(part, 0.0, 1.0);
}

}  // namespace

std::vector<double> training_sigmas(const NoiseSchedule& schedule) {
    const at::Tensor& alphas = schedule.alphas_cumprod();
    const at::Tensor sigmas = ((1 - alphas) / alphas).sqrt();
    std::vector<double> result{sigmas.data_ptr<float>(), sigmas.data_ptr<float>() + sigmas.numel()};
    // sqrt(2^24 - 1) rounds to this float, but the square root on some processors gives another
    // float. A value that is not a power of two adds a rounding error to each sample. This error is
    // visible in the small samples after the first step.
    constexpr double at_zero_snr = 4096;
    if (std::abs(result.back() / at_zero_snr - 1) < 1e-7) result.back() = at_zero_snr;
    return result;
}

double interpolate_sigma(const std::vector<double>& sigmas, double timestep) {
    const auto low = static_cast<std::size_t>(timestep);
    const double part = timestep - static_cast<double>(low);
    if (part == 0) return sigmas[low];
    return sigmas[low] + part * (sigmas[low + 1] - sigmas[low]);
}

SigmaSteps karras_steps(const std::vector<double>& sigmas, double largest, double smallest, int n) {
    constexpr double rho = 7;
    const double from = std::pow(largest, 1 / rho), to = std::pow(smallest, 1 / rho);
    SigmaSteps steps;
    for (int i = 0; i < n; ++i) {
        const double ramp = n > 1 ? static_cast<double>(i) / (n - 1) : 0;
        steps.sigmas.push_back(std::pow(from + ramp * (to - from), rho));
        steps.timesteps.push_back(timestep_of(sigmas, steps.sigmas.back()));
    }
    steps.sigmas.push_back(0);
    return steps;
}

}  // namespace item3d
