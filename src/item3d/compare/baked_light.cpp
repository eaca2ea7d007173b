#include "item3d/compare/baked_light.h"

#include "item3d/core/error.h"
#include "item3d/lighting/environment.h"
#include "item3d/report/display_image.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr int light_height = 24;    ///< sufficient for irradiance
constexpr double min_value = 1e-3;  ///< minimum luminance: black has no logarithm
constexpr double min_spread = 1e-4;

at::Tensor log_luminance(const at::Tensor& colors) {
    const at::Tensor c = colors.to(at::kDouble).cpu();
    return (0.2126 * c.select(1, 0) + 0.7152 * c.select(1, 1) + 0.0722 * c.select(1, 2))
        .clamp_min(min_value)
        .log();
}

double spread(const at::Tensor& centred) {
    return std::sqrt(centred.square().mean().item<double>());
}

}  // namespace

double baked_light(const at::Tensor& before, const at::Tensor& after, const at::Tensor& normals,
                   const Image& light) {
    ITEM3D_CHECK(before.sizes() == after.sizes() && before.sizes() == normals.sizes() &&
                     before.dim() == 2 && before.size(1) == 3,
                 "baked_light: [P, 3] each");
    if (before.size(0) == 0) return 0;
    const at::NoGradGuard no_grad;
    const Image small = resize(light, 2 * light_height, light_height);
    const at::Tensor n = normals.to(at::kFloat).cpu().contiguous();
    const float* at = n.const_data_ptr<float>();
    at::Tensor received = at::empty({n.size(0), 3});
    float* out = received.data_ptr<float>();
    for (std::int64_t i = 0; i < n.size(0); ++i, at += 3) {
        const Vec3 color = irradiance_over_pi(small, Vec3(at[0], at[1], at[2]));
        for (int c = 0; c < 3; ++c)
            *out++ = color[c];
    }
    const at::Tensor change = log_luminance(after) - log_luminance(before);
    const at::Tensor lit = log_luminance(received);
    const at::Tensor x = lit - lit.mean(), y = change - change.mean();
    const double across = spread(x), along = spread(y);
    if (across < min_spread || along < min_spread) return 0;
    return (x * y).mean().item<double>() / (across * along);
}

}  // namespace item3d
