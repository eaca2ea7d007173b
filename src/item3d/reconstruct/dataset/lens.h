// Lens models: projection of directions to pixels, and undistortion of photographs.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <array>

namespace item3d {

/// Lens in the camera models of OpenCV and COLMAP. The axes are x right, y down, z forward; pixel
/// centres are at + 0.5.
struct Lens {
    /// Image size to which the numbers below belong. It is 0 until the image is read if the dataset
    /// does not give it.
    int width = 0;
    int height = 0;
    /// Focal lengths in pixels. If `width` is 0, both are in image widths.
    double focal_x = 0, focal_y = 0;
    double centre_x = 0, centre_y = 0;  ///< principal point in pixels
    /// Coefficients k0 to k5 of the radial distortion, the factor (1 + k0 r^2 + k1 r^4 + k2 r^6) /
    /// (1 + k3 r^2 + k4 r^4 + k5 r^6) at the radius r. In a fisheye lens, the angle t becomes t (1
    /// + k0 t^2 + k1 t^4 + k2 t^6 + k3 t^8) (Kannala and Brandt 2006).
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

/// Resamples the image bilinearly to an ideal lens of the same focal_x and size. Pixels outside the
/// photograph are 0 in all channels. `lens` must be for the image's size.
Image undistort(const Image& image, const Lens& lens);

}  // namespace item3d
