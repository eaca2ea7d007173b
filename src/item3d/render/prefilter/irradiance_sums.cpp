// Sums of irradiance. The brightest texels are summed one by one, and all others together at half
// the resolution.
//
//     flux 128 --without bright--> restricted 64 --cosine sums--> 64 --upsampled--> 128
//          |                                                                         +
//          +------------------------- bright texels: max(0, n.l) f ------------------+
//
// The transpose runs from right to left. The gradient of a bright texel comes from its own sum
// alone, because the coarse map does not contain this texel.
#include "item3d/render/prefilter/irradiance_sums.h"

#include "item3d/core/error.h"
#include "item3d/render/prefilter/specular_sums.h"

#include <algorithm>

namespace item3d {

namespace {

using cuda::RenderTable;
using kernels::BrightParameters;

constexpr int coarse_size = irradiance_size / 2;
/// Minimum share of all light for a texel to be summed individually. With a smaller minimum, more
/// texels are summed individually. With a larger minimum, the kink of max(0, n.l) of a bright texel
/// becomes visible.
constexpr float bright_share = 1e-3f;

BrightParameters bright_parameters(const std::int64_t* bright, int size) {
    BrightParameters p{};
    p.texels = bright;
    p.count = max_bright;
    p.size = size;
    return p;
}

void set_bright(CubePlanes& planes, const std::int64_t* bright, const float* values) {
    BrightParameters p = bright_parameters(bright, planes.size());
    p.out = planes.writable();
    p.values = values;
    run_kernel<kernels::set_bright>(planes.backend(), "set_bright", &RenderTable::set_bright, p,
                                    p.count);
}

CubePlanes without(const CubePlanes& flux, const std::int64_t* bright) {
    CubePlanes rest = flux.clone();
    set_bright(rest, bright, nullptr);
    fill_halo(rest, CubePlanes::halo);
    return rest;
}

/// Returns the number of runs of `length` texels in the six faces of the irradiance map.
std::int64_t irradiance_runs(int length) {
    return static_cast<std::int64_t>(6) * irradiance_size * (irradiance_size / length);
}

}  // namespace

void bright_texels(const CubePlanes& flux, std::int64_t* bright) {
    const PrefilterBackend& backend = flux.backend();
    const std::int64_t face = static_cast<std::int64_t>(flux.size()) * flux.size();
    const Floats ones = backend.allocate(face), colors = backend.allocate(18 * face);
    backend.fill(ones.get(), face, 1);
    from_planes(flux, ones.get(), colors.get());
    backend.brightest(colors.get(), 6 * face, bright_share, max_bright, bright);
}

CubePlanes irradiance_sums(const CubePlanes& flux, const std::int64_t* bright) {
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
    const int length = run_length(flux.backend(), irradiance_size);
    run_kernel<kernels::add_bright<irradiance_size>>(flux.backend(), "bright_irradiance",
                                                     &RenderTable::add_bright, p,
                                                     irradiance_runs(length), 16);
    return sums;
}

CubePlanes irradiance_sums_transposed(const CubePlanes& gradient, int size,
                                      const std::int64_t* bright) {
    const PrefilterBackend& backend = gradient.backend();
    CubePlanes coarse = cosine_sums(restricted(gradient), std::min(size, coarse_size));
    if (size == irradiance_size) {
        fill_halo(coarse, 1);
        coarse = upsampled(coarse);
    }
    const int length = backend.on_device() ? kernels::device_bright_run : irradiance_size;
    const std::int64_t runs = irradiance_runs(length), columns = 3 * max_bright;
    const Floats partial_sums = backend.allocate(runs * columns);
    BrightParameters p = bright_parameters(bright, size);
    p.gradient = gradient.view();
    p.partial_sums = partial_sums.get();
    run_kernel<kernels::sum_bright<irradiance_size>>(backend, "bright_irradiance_gradient",
                                                     &RenderTable::sum_bright, p, runs, 16);
    const Floats sums = backend.allocate(columns);
    backend.sum_rows(partial_sums.get(), runs, columns, /*precise=*/false, sums.get());
    set_bright(coarse, bright, sums.get());
    return coarse;
}

}  // namespace item3d
