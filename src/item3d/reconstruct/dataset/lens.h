// How a photograph's pixels relate to directions, and photographs as an ideal lens would have made
// them.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <array>

namespace item3d {

/// OpenCV's and COLMAP's camera models: x right, y down, z forward; pixel centres at + 0.5.
struct Lens {
    int width = 0;  ///< pixels that the numbers below are for; 0: not known before the picture is
    int height = 0;
    /// Focal lengths in pixels. Where `width` is 0: in widths of the picture, for both axes.
    double focal_x = 0, focal_y = 0;
    double centre_x = 0, centre_y = 0;  ///< principal point in pixels
    /// Radial: (1 + k0 r^2 + k1 r^4 + k2 r^6) / (1 + k3 r^2 + k4 r^4 + k5 r^6). Of a fisheye: the
    /// angle t becomes t (1 + k0 t^2 + k1 t^4 + k2 t^6 + k3 t^8) (Kannala and Brandt 2006).
    std::array<double, 6> radial{};
    std::array<double, 2> tangential{};
    bool fisheye = false;

    /// A plain pinhole whose principal point is the middle and whose pixels are square.
    bool is_ideal() const;
    /// For a picture of another size: scaled. With `width` 0: of this size from now on.
    Lens scaled_to(int new_width, int new_height) const;
    /// Horizontal field of view, in radians, of an ideal lens with the same focal_x.
    float field_of_view_x() const;
    /// Where the direction (x, y, 1) is seen, in pixels.
    glm::dvec2 project(double x, double y) const;
};

/// The picture that an ideal lens of the same focal_x and size would have made, bilinear. What such
/// a lens sees and the photograph does not show is 0 in all channels. `lens` is for this size.
Image undistort(const Image& picture, const Lens& lens);

}  // namespace item3d
