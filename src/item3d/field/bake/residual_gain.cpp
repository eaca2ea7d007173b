#include "item3d/field/bake/residual_gain.h"

#include "item3d/field/bake/fill.h"
#include "item3d/field/bake/texel_values.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace item3d {
namespace {

constexpr int finest_grid = 256;  ///< cells along the longest edge
constexpr int radius = 3;         ///< radius of the window, in cells
/// Squared contrast, over three encoded channels, below which the source counts as flat.
constexpr float flat = 0.002f;

std::pair<int, int> grid_size(int width, int height) {
    const double scale = std::min(1.0, static_cast<double>(finest_grid) / std::max(width, height));
    return {std::max(1, static_cast<int>(std::lround(width * scale))),
            std::max(1, static_cast<int>(std::lround(height * scale)))};
}

at::Tensor window_mean(const at::Tensor& cells) {
    constexpr int size = 2 * radius + 1;
    return at::avg_pool2d(cells, {size, size}, {1, 1}, {radius, radius});
}

/// Returns the encoded base colours of both fields, and the coverage, [1, 7, height, width].
at::Tensor sample_cells(const BakeScene& scene, const TextureSet& set, int width, int height,
                        NeuralTexture& fitted, NeuralTexture& now) {
    at::Tensor cells = at::zeros({1, 7, height, width});
    auto cell = cells.accessor<float, 4>();
    const TexelEvaluator evaluator(scene, set, width, height, 1, {});
    evaluator.for_rows(fitted, now, [&](const std::vector<TexelValue>& texels) {
        for (const TexelValue& texel : texels) {
            for (int c = 0; c < 3; ++c) {
                cell[0][c][texel.y][texel.x] = linear_to_srgb(texel.fitted.base_color[c]);
                cell[0][3 + c][texel.y][texel.x] = linear_to_srgb(texel.now.base_color[c]);
            }
            cell[0][6][texel.y][texel.x] = 1;
        }
    });
    return cells;
}

}  // namespace

ResidualGain::ResidualGain(const BakeScene& scene, const TextureSet& set, int width, int height,
                           NeuralTexture& fitted, NeuralTexture& now)
    : width_(width), height_(height) {
    const auto [columns, rows] = grid_size(width, height);
    const at::NoGradGuard no_grad;
    const at::Tensor cells = sample_cells(scene, set, columns, rows, fitted, now);
    const at::Tensor covered = cells.narrow(1, 6, 1);
    const at::Tensor share = window_mean(covered).clamp_min(1e-6);
    const auto mean = [&](const at::Tensor& values) {
        return window_mean(values * covered) / share;
    };
    const at::Tensor before = cells.narrow(1, 0, 3), after = cells.narrow(1, 3, 3);
    const at::Tensor mean_before = mean(before);
    const auto contrast = [&](const at::Tensor& with) {
        return (mean(before * with) - mean_before * mean(with)).sum(1, true);
    };
    const at::Tensor slope = (contrast(after) + flat) / (contrast(before).clamp_min(0) + flat);
    const at::Tensor gain = mean(slope.clamp(0, 1)).contiguous();

    gain_ = Image(columns, rows, 1);
    std::copy_n(gain.data_ptr<float>(), gain_.pixels.size(), gain_.pixels.begin());
    std::vector<std::uint8_t> has_value(gain_.pixels.size());
    const at::Tensor mask = covered.contiguous();
    std::transform(mask.data_ptr<float>(), mask.data_ptr<float>() + has_value.size(),
                   has_value.begin(), [](float value) { return value > 0; });
    fill_uncovered(gain_, has_value);
}

float ResidualGain::at(int x, int y) const {
    const auto place = [](int texel, int texels, int cells) {
        const float at = (static_cast<float>(texel) + 0.5f) * static_cast<float>(cells) /
                             static_cast<float>(texels) -
                         0.5f;
        return std::clamp(at, 0.0f, static_cast<float>(cells - 1));
    };
    const float u = place(x, width_, gain_.width), v = place(y, height_, gain_.height);
    const int left = static_cast<int>(u), top = static_cast<int>(v);
    const int right = std::min(left + 1, gain_.width - 1);
    const int bottom = std::min(top + 1, gain_.height - 1);
    const float across = u - static_cast<float>(left), down = v - static_cast<float>(top);
    return std::lerp(std::lerp(gain_.at(left, top, 0), gain_.at(right, top, 0), across),
                     std::lerp(gain_.at(left, bottom, 0), gain_.at(right, bottom, 0), across),
                     down);
}

}  // namespace item3d
