#include "item3d/render/irradiance_sums.h"

#include "item3d/core/error.h"
#include "item3d/core/math.h"
#include "item3d/render/prefilter_sums.h"

#include <algorithm>

namespace item3d {

using kernels::CubePlanes;

namespace {

constexpr int coarse_size = irradiance_size / 2;
constexpr std::size_t most_bright = 64;
constexpr float bright_share = 1e-3f;  ///< of all light

struct Place {
    int face, row, column;
};
Place place_of(std::int64_t index, int size) {
    const std::int64_t in_face = index % (static_cast<std::int64_t>(size) * size);
    return {static_cast<int>(index / (static_cast<std::int64_t>(size) * size)),
            static_cast<int>(in_face / size), static_cast<int>(in_face % size)};
}

Vec3 unit_direction(const Place& place, int size) {
    return glm::normalize(kernels::cube_direction(place.face,
                                                  kernels::texel_centre(place.column, size),
                                                  kernels::texel_centre(place.row, size)));
}

/// A row of unit normals of the irradiance map.
struct NormalRow {
    float x[irradiance_size], y[irradiance_size], z[irradiance_size];
    NormalRow(int face, int row) {
        for (int column = 0; column < irradiance_size; ++column) {
            const Vec3 n = unit_direction({face, row, column}, irradiance_size);
            x[column] = n.x;
            y[column] = n.y;
            z[column] = n.z;
        }
    }
};

CubePlanes without(const CubePlanes& flux, const std::vector<std::int64_t>& bright) {
    CubePlanes rest(flux.size(), flux.shared_plane());
    rest.clear();
    kernels::add(rest, flux);
    for (const std::int64_t index : bright) {
        const Place at = place_of(index, flux.size());
        for (int c = 0; c < 3; ++c)
            rest.row(3 * at.face + c, at.row)[at.column] = 0;
    }
    kernels::fill_halo(rest, CubePlanes::halo);
    return rest;
}

}  // namespace

std::vector<std::int64_t> bright_texels(const CubePlanes& flux) {
    const int size = flux.size();
    std::vector<float> light(static_cast<std::size_t>(6) * size * size);
    double total = 0;
    for (std::size_t i = 0; i < light.size(); ++i) {
        const Place at = place_of(static_cast<std::int64_t>(i), size);
        for (int c = 0; c < 3; ++c)
            light[i] += flux.row(3 * at.face + c, at.row)[at.column];
        total += std::max(0.0f, light[i]);
    }
    const float least = bright_share * static_cast<float>(total);
    std::vector<std::int64_t> bright;
    for (std::size_t i = 0; i < light.size(); ++i)
        if (light[i] > least) bright.push_back(static_cast<std::int64_t>(i));
    if (bright.size() > most_bright) {
        std::stable_sort(bright.begin(), bright.end(), [&](std::int64_t a, std::int64_t b) {
            return light[static_cast<std::size_t>(a)] > light[static_cast<std::size_t>(b)];
        });
        bright.resize(most_bright);
        std::sort(bright.begin(), bright.end());
    }
    return bright;
}

CubePlanes irradiance_sums(const CubePlanes& flux, const std::vector<std::int64_t>& bright) {
    const int size = flux.size();
    ITEM3D_CHECK(size <= irradiance_size, "irradiance_sums: a map of at most 128 texels");
    const auto sums_of = [&](const CubePlanes& map) {
        return size == irradiance_size ? cosine_sums(kernels::restricted(map), coarse_size)
                                       : cosine_sums(map, coarse_size);
    };
    CubePlanes coarse = bright.empty() ? sums_of(flux) : sums_of(without(flux, bright));
    kernels::fill_halo(coarse, 1);
    CubePlanes sums = kernels::upsampled(coarse);
    if (bright.empty()) return sums;
    parallel_for(
        "bright_irradiance", static_cast<std::int64_t>(6) * irradiance_size,
        [&](std::int64_t i) {
            const int face = static_cast<int>(i / irradiance_size);
            const int row = static_cast<int>(i % irradiance_size);
            const NormalRow n(face, row);
            float* __restrict red = sums.row(3 * face, row);
            float* __restrict green = sums.row(3 * face + 1, row);
            float* __restrict blue = sums.row(3 * face + 2, row);
            for (const std::int64_t index : bright) {
                const Place at = place_of(index, size);
                const Vec3 d = unit_direction(at, size);
                const float r = flux.row(3 * at.face, at.row)[at.column];
                const float g = flux.row(3 * at.face + 1, at.row)[at.column];
                const float b = flux.row(3 * at.face + 2, at.row)[at.column];
                for (int x = 0; x < irradiance_size; ++x) {
                    const float dot = n.x[x] * d.x + n.y[x] * d.y + n.z[x] * d.z;
                    const float cosine = dot > 0 ? dot : 0.0f;
                    red[x] += cosine * r;
                    green[x] += cosine * g;
                    blue[x] += cosine * b;
                }
            }
        },
        16);
    return sums;
}

CubePlanes irradiance_sums_transposed(const CubePlanes& gradient, int size,
                                      const std::vector<std::int64_t>& bright) {
    CubePlanes coarse = cosine_sums(kernels::restricted(gradient), std::min(size, coarse_size));
    if (size == irradiance_size) {
        kernels::fill_halo(coarse, 1);
        coarse = kernels::upsampled(coarse);
    }
    if (bright.empty()) return coarse;
    std::vector<NormalRow> normals;
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row < irradiance_size; ++row)
            normals.emplace_back(face, row);
    parallel_for(
        "bright_irradiance_gradient", static_cast<std::int64_t>(bright.size()),
        [&](std::int64_t k) {
            const Place at = place_of(bright[static_cast<std::size_t>(k)], size);
            const Vec3 d = unit_direction(at, size);
            double sums[3] = {0, 0, 0};
            for (int face = 0; face < 6; ++face)
                for (int row = 0; row < irradiance_size; ++row) {
                    const NormalRow& n =
                        normals[static_cast<std::size_t>(face * irradiance_size + row)];
                    float cosine[irradiance_size];
                    for (int x = 0; x < irradiance_size; ++x) {
                        const float dot = n.x[x] * d.x + n.y[x] * d.y + n.z[x] * d.z;
                        cosine[x] = dot > 0 ? dot : 0.0f;
                    }
                    for (int c = 0; c < 3; ++c) {
                        const float* in = gradient.row(3 * face + c, row);
                        float partial[8] = {};
                        for (int x = 0; x < irradiance_size; x += 8)
                            for (int lane = 0; lane < 8; ++lane)
                                partial[lane] += cosine[x + lane] * in[x + lane];
                        for (const float part : partial)
                            sums[c] += static_cast<double>(part);
                    }
                }
            for (int c = 0; c < 3; ++c)
                coarse.row(3 * at.face + c, at.row)[at.column] = static_cast<float>(sums[c]);
        },
        1);
    return coarse;
}

}  // namespace item3d
