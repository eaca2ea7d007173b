// The list of silhouette crossings of all pixels, on the CPU's threads.
#pragma once

#include "item3d/core/parallel.h"
#include "item3d/render/kernels/antialias.h"

#include <algorithm>
#include <vector>

namespace item3d {

/// Returns the crossings of each row of all views, [N * H], in the order of their pixels.
inline std::vector<std::vector<kernels::Crossing>> list_crossings(
    const kernels::AntialiasParameters& p, std::int64_t views) {
    const std::int64_t rows = views * p.height;
    std::vector<std::vector<kernels::Crossing>> by_row(static_cast<std::size_t>(rows));
    parallel_for(
        "find_crossings", rows,
        [&](std::int64_t row) {
            kernels::Crossing crossing;
            std::vector<kernels::Crossing>& found = by_row[static_cast<std::size_t>(row)];
            for (int x = 0; x < p.width; ++x) {
                const std::int64_t pixel = row * p.width + x;
                if (x + 1 < p.width && kernels::find_crossing(p, pixel, false, crossing))
                    found.push_back(crossing);
                if (row % p.height + 1 < p.height &&
                    kernels::find_crossing(p, pixel, true, crossing))
                    found.push_back(crossing);
            }
        },
        std::max(1, 16384 / p.width));
    return by_row;
}

}  // namespace item3d
