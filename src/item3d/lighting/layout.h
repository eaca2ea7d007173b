// Layouts of lights in other programs (cube maps and light probes), and their conversion to
// equirectangular images.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace item3d {

enum class LightLayout {
    automatic,        ///< chosen by the aspect ratio
    equirectangular,  ///< 2:1
    /// Six faces of an unfolded box, seen from inside. The faces right (+X), left, up and down
    /// adjoin the four sides of the front (-Z). The back is beyond the right face (4:3), or upside
    /// down below the lower face (3:4).
    cross,
    /// Six faces in a row (6:1) or a column (1:6), seen from inside: right, left, up, down, front,
    /// back. The lower edge of "up" and the upper edge of "down" meet the front. This is the order
    /// +X -X +Y -Y +Z -Z of graphics APIs, whose cube maps look along +Z.
    strip,
    /// A light probe (Debevec 1998), 1:1. The centre looks to -Z. The distance from the centre,
    /// divided by half the side, equals the angle from -Z, divided by 180 degrees.
    angular
};

/// Returns "auto", "equirectangular", "cross", "strip", "angular".
const std::vector<std::string>& light_layout_names();
/// Throws InputError on other names.
LightLayout parse_light_layout(const std::string& name);

/// Converts a light. image: linear RGB. Returns height x 2*height x 3. height is twice the edge
/// length of a cube's face, or half the edge length of a probe. An equirectangular image is
/// returned unchanged. Throws InputError that names `subject` if the aspect ratio does not match
/// the layout, or if no layout is given and the aspect ratio matches none.
Image to_equirectangular(const Image& image, LightLayout layout, const std::string& subject);

/// Axes of a cube's face, seen from inside.
struct CubeFaceAxes {
    Vec3 forward;
    Vec3 right;
    Vec3 up;
};

/// Converts six square faces in a row to an equirectangular light that is twice as high as a face.
Image faces_to_equirectangular(const Image& row, const std::array<CubeFaceAxes, 6>& axes);

/// Returns an equirectangular light of `height` rows from a function that gives the radiance from a
/// direction. It is sampled four times per texel.
Image light_from(int height, const std::function<Vec3(Vec3)>& radiance);

/// Returns the radiance in a direction, interpolated bilinearly.
Vec3 look_up(const Image& light, Vec3 direction);

}  // namespace item3d
