// Lens models: projection of directions to pixels, and undistortion of photographs.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <array>

namespace item3d {

/// Lens in the camera models of OpenCV and COLMAP: x right, y down, z forward; pixel centres at +
/// 0.5.
struct Lens {
    int width = 0;  ///< image size of the numbers below; 0: unknown until the image is read
    int height = 0;
    /// Focal lengths in pixels. If `width` is 0: in image widths, for both axes.
    double focal_x = 0, focal_y = 0;
    double centre_x = 0, centre_y = 0;  ///< principal point in pixels
    /// Radial distortion: (1 + k0 r^2 + k1 r^4 + k2 r^6) / (1 + k3 r^2 + k4 r^4 + k5 r^6). For a
    /// fisheye: the angle t becomes t (1 + k0 t^2 + k1 t^4 + k2 t^6 + k3 t^8) (Kannala and Brandt
    /// 2006).
    std::array<double, 6> radial{};
    std::array<double, 2> tangential{};
    bool fisheye = false;

    /// True for a pinhole with a central principal point and square pixels.
    bool is_ideal() const;
    /// Returns the lens scaled to another image size. If `width` is 0, the returned lens has the
    /// given size.
    Lens scaled_to(int new_width, int new_height) const;
    /// Returns the horizontal field of view, in radians, of an ideal lens with the same focal_x.
    float field_of_view_x() const;
    /// Projects the direction (x, y, 1) to pixels.
    glm::dvec2 project(double x, double y) const;
};

/// Resamples the image to an ideal lens of the same focal_x and size, bilinear. Pixels outside the
/// photograph are 0 in all channels. lens: must be for the image's size.
Image undistort(const Image& image, const Lens& lens);

}  // namespace item3d
