// Irradiance: the sum of all texels but the brightest at half the resolution, and those one by one.
//
//     flux 128 --without bright--> restricted 64 --cosine sums--> 64 --upsampled--> 128
//          |                                                                         +
//          +------------------------- bright texels: max(0, n.l) f ------------------+
//
// The transpose runs from right to left; the gradient of a bright texel is set by its own sum,
// since the way through the coarse map did not see it.
#include "item3d/render/prefilter/irradiance_sums.h"

#include "item3d/core/error.h"
#include "item3d/render/dispatch.h"
#include "item3d/render/prefilter/specular_sums.h"
#include "item3d/tensors/tensor.h"

#include <algorithm>

namespace item3d {

namespace {

using cuda::RenderTable;
using kernels::BrightParameters;

constexpr int coarse_size = irradiance_size / 2;
/// Number of texels that are summed one by one: room for a sun; each costs a cosine a normal.
constexpr std::int64_t max_bright = 64;
/// Share of all light from which a texel is summed by itself: a lower one takes more texels, a
/// higher one shows a light's kink at the horizon.
constexpr float bright_share = 1e-3f;

BrightParameters bright_parameters(const at::Tensor& bright, int size) {
    BrightParameters p{};
    p.texels = bright.const_data_ptr<std::int64_t>();
    p.count = static_cast<int>(bright.numel());
    p.size = size;
    return p;
}

void set_bright(CubePlanes& planes, const at::Tensor& bright, const float* values) {
    BrightParameters p = bright_parameters(bright, planes.size());
    p.out = planes.writable();
    p.values = values;
    dispatch<kernels::set_bright>(planes.device(), "set_bright", &RenderTable::set_bright, p,
                                  p.count);
}

CubePlanes without(const CubePlanes& flux, const at::Tensor& bright) {
    CubePlanes rest = flux.clone();
    set_bright(rest, bright, nullptr);
    fill_halo(rest, CubePlanes::halo);
    return rest;
}

/// Returns the number of runs of the irradiance map's texels over six faces.
std::int64_t irradiance_runs(int length) {
    return static_cast<std::int64_t>(6) * irradiance_size * (irradiance_size / length);
}

}  // namespace

at::Tensor bright_texels(const CubePlanes& flux) {
    const at::Tensor light =
        from_planes(flux, at::ones({flux.size(), flux.size()}, flux.options())).sum(-1).flatten();
    const at::Tensor minimum = bright_share * light.clamp_min(0).sum();
    const auto [brightest, texels] = at::topk(light, max_bright);
    return at::where(brightest > minimum, texels, -1);
}

CubePlanes irradiance_sums(const CubePlanes& flux, const at::Tensor& bright) {
    const int size = flux.size();
    ITEM3D_CHECK(size <= irradiance_size, "irradiance_sums: a map of at most 128 texels");
    const CubePlanes rest = without(flux, bright);
    CubePlanes coarse = size == irradiance_size ? cosine_sums(restricted(rest), coarse_size)
                                                : cosine_sums(rest, coarse_size);
    fill_halo(coarse, 1);
    CubePlanes sums = upsampled(coarse);
    BrightParameters p = bright_parameters(bright, size);
    p.flux = flux.view();
    p.out = sums.writable();
    const int length = run_length(flux.device(), irradiance_size);
    dispatch<kernels::add_bright<irradiance_size>>(flux.device(), "bright_irradiance",
                                                   &RenderTable::add_bright, p,
                                                   irradiance_runs(length), 16);
    return sums;
}

CubePlanes irradiance_sums_transposed(const CubePlanes& gradient, int size,
                                      const at::Tensor& bright) {
    CubePlanes coarse = cosine_sums(restricted(gradient), std::min(size, coarse_size));
    if (size == irradiance_size) {
        fill_halo(coarse, 1);
        coarse = upsampled(coarse);
    }
    const int length = gradient.device().is_cuda() ? kernels::device_bright_run : irradiance_size;
    const std::int64_t runs = irradiance_runs(length);
    const at::Tensor partial_sums = at::empty({runs, bright.numel(), 3}, gradient.options());
    BrightParameters p = bright_parameters(bright, size);
    p.gradient = gradient.view();
    p.partial_sums = partial_sums.data_ptr<float>();
    dispatch<kernels::sum_bright<irradiance_size>>(gradient.device(), "bright_irradiance_gradient",
                                                   &RenderTable::sum_bright, p, runs, 16);
    const at::Tensor sums = partial_sums.sum(0);
    set_bright(coarse, bright, sums.const_data_ptr<float>());
    return coarse;
}

}  // namespace item3d
