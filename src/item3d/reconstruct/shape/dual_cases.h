// Case table of dual marching cubes (Nielson 2004, "Dual Marching Cubes"): the loops of crossed
// edges for each set of corners inside the surface.
#pragma once

#include <array>

namespace item3d {

/// Returns the index of a cube's edge that runs along `axis` from corner `lower`, whose bit of that
/// axis is 0. Corner i of a cube is at (i & 1, i >> 1 & 1, i >> 2).
constexpr int cube_edge(int axis, int lower) {
    constexpr int first = 4;
    const int rank = axis == 0   ? lower >> 1
                     : axis == 1 ? (lower & 1) | (lower >> 2 << 1)
                                 : lower & 3;
    return first * axis + rank;
}

/// Returns the ends of an edge, the lower first.
std::array<int, 2> cube_edge_ends(int edge);

struct DualCase {
    int loops = 0;  ///< number of loops, up to 4; each becomes a vertex
    /// Loop that crosses each edge; -1 if no loop crosses it.
    std::array<int, 12> loop_of_edge{};
    /// The only face that a single loop crosses twice, as 2 * axis + side; -1 if there is none. If
    /// this face is doubled in both cubes that share it, two mesh edges would connect the same two
    /// vertices, and the mesh would not be manifold. The turned case of both cubes (see dual_case)
    /// avoids this.
    int doubled_face = -1;
};

/// Returns a case; bit i of `inside` is set if corner i is inside. If only two opposite corners of
/// a face are inside, the surface separates these corners on this face. If `turned` is true, the
/// surface joins them on the doubled face.
const DualCase& dual_case(int inside, bool turned = false);

}  // namespace item3d
