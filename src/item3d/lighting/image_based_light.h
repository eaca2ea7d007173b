// Environment lights in the form of glTF's EXT_lights_image_based.
#pragma once

#include "item3d/lighting/layout.h"
#include "item3d/scene/image.h"

#include <array>
#include <vector>

namespace item3d {

/// Axes of the faces +X, -X, +Y, -Y, +Z, -Z. These are the faces of OpenGL's cube maps, mirrored so
/// that they are seen from inside, as the extension requires.
extern const std::array<CubeFaceAxes, 6> gltf_face_axes;

/// Returns real spherical harmonics of bands 0 to 2 in the direction d (unit), in the order and
/// with the signs of Ramamoorthi and Hanrahan 2001, "An Efficient Representation for Irradiance
/// Environment Maps": 1; y, z, x; xy, yz, 3z^2 - 1, xz, x^2 - y^2, each with its positive constant.
std::array<float, 9> spherical_harmonics(Vec3 d);

struct ImageBasedLight {
    /// Coefficients of irradiance, linear RGB. Their sum, weighted by spherical_harmonics(d), is
    /// the irradiance on a surface that faces d. The radiance of a white surface is irradiance /
    /// pi.
    std::array<Vec3, 9> irradiance;
    /// Linear RGB radiance, prefiltered by GGX. Level k of n is for the roughness k / (n - 1), and
    /// has half the resolution of the previous level. An image has the six faces of gltf_face_axes
    /// in a row.
    std::vector<Image> specular;
};

/// Returns the coefficients of irradiance. light: equirectangular, height x width x 3.
std::array<Vec3, 9> irradiance_harmonics(const Image& light);

}  // namespace item3d
