// Where the corners of a cube are inside or outside: the loops in which a surface crosses its
// edges, for dual marching cubes (Nielson 2004, "Dual Marching Cubes").
#pragma once

#include <array>

namespace item3d {

/// Corner i of a cube is at (i & 1, i >> 1 & 1, i >> 2). Its edge along `axis` from corner `lower`
/// (whose bit of that axis is 0).
constexpr int cube_edge(int axis, int lower) {
    constexpr int first = 4;
    const int rank = axis == 0   ? lower >> 1
                     : axis == 1 ? (lower & 1) | (lower >> 2 << 1)
                                 : lower & 3;
    return first * axis + rank;
}

/// The ends of an edge, the lower first.
std::array<int, 2> cube_edge_ends(int edge);

struct DualCase {
    int loops = 0;  ///< up to 4; each becomes a vertex
    /// By edge: the loop that crosses it; -1: the surface does not.
    std::array<int, 12> loop_of_edge{};
    /// 2 * axis + side of the one face that a loop crosses twice; -1: none. Where two cubes meet at
    /// such a face of both, their two vertices would have two edges in common, which is no
    /// manifold. With the face turned (see dual_case) they do not.
    int doubled_face = -1;
};

/// inside: bit i is set when corner i is. On a face whose inside corners are opposite ones they are
/// kept apart; on the doubled face they are joined if `turned`.
const DualCase& dual_case(int inside, bool turned = false);

}  // namespace item3d
