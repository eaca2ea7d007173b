#include "item3d/reconstruct/dataset/lens.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"

#include <algorithm>
#include <cmath>

namespace item3d {

bool Lens::is_ideal() const {
    const auto is_zero = [](double value) { return value == 0; };
    // Distortion below a thousandth of a pixel is invisible, but the resampling that removes it
    // would be visible.
    return !fisheye && std::all_of(radial.begin(), radial.end(), is_zero) &&
           std::all_of(tangential.begin(), tangential.end(), is_zero) &&
           std::abs(focal_x - focal_y) * height < 1e-3 * focal_x &&
           std::abs(centre_x - 0.5 * width) < 1e-3 && std::abs(centre_y - 0.5 * height) < 1e-3;
}

Lens Lens::scaled_to(int new_width, int new_height) const {
    Lens lens = *this;
    lens.width = new_width;
    lens.height = new_height;
    if (width == 0) {
        lens.focal_x = lens.focal_y = focal_x * new_width;
        lens.centre_x = 0.5 * new_width;
        lens.centre_y = 0.5 * new_height;
        return lens;
    }
    const double x = static_cast<double>(new_width) / width;
    const double y = static_cast<double>(new_height) / height;
    lens.focal_x *= x;
    lens.centre_x *= x;
    lens.focal_y *= y;
    lens.centre_y *= y;
    return lens;
}

float Lens::field_of_view_x() const {
    return static_cast<float>(2 * std::atan2(0.5 * width, focal_x));
}

glm::dvec2 Lens::project(double x, double y) const {
    const double r = std::hypot(x, y), r2 = r * r;
    if (fisheye) {
        const double t = std::atan(r), t2 = t * t;
        const double bent =
            t * (1 + t2 * (radial[0] + t2 * (radial[1] + t2 * (radial[2] + t2 * radial[3]))));
        const double scale = r > 1e-12 ? bent / r : 1.0;
        return {focal_x * x * scale + centre_x, focal_y * y * scale + centre_y};
    }
    const double scale = (1 + r2 * (radial[0] + r2 * (radial[1] + r2 * radial[2]))) /
                         (1 + r2 * (radial[3] + r2 * (radial[4] + r2 * radial[5])));
    const double u = x * scale + 2 * tangential[0] * x * y + tangential[1] * (r2 + 2 * x * x);
    const double v = y * scale + tangential[0] * (r2 + 2 * y * y) + 2 * tangential[1] * x * y;
    return {focal_x * u + centre_x, focal_y * v + centre_y};
}

Image undistort(const Image& image, const Lens& lens) {
    ITEM3D_CHECK(image.width == lens.width && image.height == lens.height,
                 "the lens has another image size");
    if (lens.is_ideal()) return image;
    Image result(image.width, image.height, image.channels);
    const auto value = [&](int x, int y, int c) {
        return x < 0 || y < 0 || x >= image.width || y >= image.height ? 0.0f : image.at(x, y, c);
    };
    const auto undistort_pixel = [&](int x, int y) {
        const glm::dvec2 at = lens.project((x + 0.5 - 0.5 * lens.width) / lens.focal_x,
                                           (y + 0.5 - 0.5 * lens.height) / lens.focal_x) -
                              0.5;
        // Far outside the image a lens's polynomial is meaningless.
        if (!(at.x > -1 && at.y > -1 && at.x < image.width && at.y < image.height)) return;
        const int x0 = static_cast<int>(std::floor(at.x)), y0 = static_cast<int>(std::floor(at.y));
        const auto u = static_cast<float>(at.x - x0), v = static_cast<float>(at.y - y0);
        for (int c = 0; c < image.channels; ++c) {
            const float top = std::lerp(value(x0, y0, c), value(x0 + 1, y0, c), u);
            const float bottom = std::lerp(value(x0, y0 + 1, c), value(x0 + 1, y0 + 1, c), u);
            result.at(x, y, c) = std::lerp(top, bottom, v);
        }
    };
    parallel_for(
        "undistort", image.height,
        [&](std::int64_t y) {
            for (int x = 0; x < image.width; ++x)
                undistort_pixel(x, static_cast<int>(y));
        },
        16);
    return result;
}

}  // namespace item3d
