// Rasterization on the CPU's threads, in bands of rows.
#pragma once

#include "item3d/core/parallel.h"
#include "item3d/render/kernels/raster.h"

#include <algorithm>
#include <vector>

namespace item3d {

/// Lists of triangles. For each band of rows of each view, a list has the triangles that may touch
/// the band, in ascending order. A triangle that covers no pixel centre, like most triangles of a
/// dense mesh, is in no list.
class BandBins {
  public:
    BandBins(const kernels::RasterParameters& parameters, std::int64_t views, std::int64_t bands)
        : bands_(bands),
          chunks_((parameters.triangle_count + chunk - 1) / chunk),
          lists_(static_cast<std::size_t>(views * bands * chunks_)) {
        std::vector<int> band_of_row;
        for (std::int64_t band = 0; band < bands; ++band)
            band_of_row.resize(static_cast<std::size_t>(end_row(parameters.height, band)),
                               static_cast<int>(band));
        parallel_for(
            "bound_triangles", views * chunks_,
            [&](std::int64_t i) {
                const std::int64_t view = i / chunks_, first = i % chunks_ * chunk;
                const std::int64_t last = std::min(first + chunk, parameters.triangle_count);
                for (std::int64_t t = first; t < last; ++t) {
                    const kernels::PixelBox box = kernels::bound_triangle(parameters, view, t);
                    if (box.x0 >= box.x1 || box.y0 >= box.y1) continue;
                    const int top = band_of_row[static_cast<std::size_t>(box.y0)];
                    const int bottom = band_of_row[static_cast<std::size_t>(box.y1 - 1)];
                    for (int band = top; band <= bottom; ++band)
                        list(view, band, i % chunks_).push_back(static_cast<std::int32_t>(t));
                }
            },
            1);
    }

    int end_row(int height, std::int64_t band) const {
        return static_cast<int>(height * (band + 1) / bands_);
    }
    template <typename F>
    void for_each(std::int64_t view, std::int64_t band, const F& visit) {
        for (std::int64_t i = 0; i < chunks_; ++i)
            for (const std::int32_t t : list(view, band, i))
                visit(t);
    }

  private:
    static constexpr std::int64_t chunk = 16384;

    std::vector<std::int32_t>& list(std::int64_t view, std::int64_t band, std::int64_t index) {
        return lists_[static_cast<std::size_t>((view * bands_ + band) * chunks_ + index)];
    }

    std::int64_t bands_, chunks_;
    std::vector<std::vector<std::int32_t>> lists_;
};

/// Rasterizes all views. Bands of rows are independent, so their number changes no result. Images
/// that take less than a millisecond use one band for each view. The caller must initialise the
/// outputs as an empty image.
inline void rasterize_on_cpu(const kernels::RasterParameters& parameters, std::int64_t views) {
    const int width = parameters.width, height = parameters.height;
    const bool small = views * width * height < 32768 && views * parameters.triangle_count < 32768;
    const std::int64_t bands =
        small ? 1
              : std::clamp<std::int64_t>(4 * thread_count() / views, 1, std::max(1, height / 16));
    BandBins bins(parameters, views, bands);
    parallel_for(
        "rasterize", views * bands,
        [&](std::int64_t i) {
            const std::int64_t view = i / bands, band = i % bands;
            const int row_begin = bins.end_row(height, band - 1);
            const int row_end = bins.end_row(height, band);
            bins.for_each(view, band, [&](std::int64_t t) {
                kernels::rasterize_triangle(parameters, view, t, row_begin, row_end);
            });
            for (std::int64_t pixel = (view * height + row_begin) * width;
                 pixel < (view * height + row_end) * width; ++pixel)
                kernels::finish_depth(parameters, pixel);
        },
        small ? views : 1);
}

}  // namespace item3d
