#include "item3d/reconstruct/dataset/orientation.h"

#include "item3d/core/error.h"

namespace item3d {

bool swaps_sides(int orientation) {
    return orientation >= 5;
}

Image oriented(const Image& stored, int orientation) {
    if (orientation == 1) return stored;
    const bool swaps = swaps_sides(orientation);
    Image result(swaps ? stored.height : stored.width, swaps ? stored.width : stored.height,
                 stored.channels);
    // An EXIF orientation states at which sides of the shown image the first stored row and column
    // are.
    const bool from_right =
        orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
    const bool from_bottom =
        orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
    for (int y = 0; y < stored.height; ++y) {
        for (int x = 0; x < stored.width; ++x) {
            int u = swaps ? y : x, v = swaps ? x : y;
            if (from_right) u = result.width - 1 - u;
            if (from_bottom) v = result.height - 1 - v;
            for (int c = 0; c < stored.channels; ++c)
                result.at(u, v, c) = stored.at(x, y, c);
        }
    }
    return result;
}

int inverse_orientation(int orientation) {
    return orientation == 6 ? 8 : orientation == 8 ? 6 : orientation;
}

bool is_turn(int orientation) {
    return orientation == 3 || orientation == 6 || orientation == 8;
}

Mat4 oriented_camera(const Mat4& camera_to_world, int orientation) {
    if (orientation == 1) return camera_to_world;
    ITEM3D_CHECK(is_turn(orientation), "a mirrored orientation is not supported");
    Mat4 result = camera_to_world;
    const Vec4 right = camera_to_world[0], up = camera_to_world[1];
    result[0] = orientation == 3 ? -right : orientation == 6 ? up : -up;
    result[1] = orientation == 3 ? -up : orientation == 6 ? -right : right;
    return result;
}

}  // namespace item3d
