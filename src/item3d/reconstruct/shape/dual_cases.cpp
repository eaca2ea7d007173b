#include "item3d/reconstruct/shape/dual_cases.h"

#include "item3d/core/error.h"

#include <utility>

namespace item3d {

namespace {

constexpr int no_face = -1;

/// Returns the corners of face 2 * axis + side, counter-clockwise from outside the cube.
std::array<int, 4> face_corners(int face) {
    const int axis = face / 2;
    const int across = 1 << (axis + 1) % 3, up = 1 << (axis + 2) % 3;
    const int base = face % 2 == 0 ? 0 : 1 << axis;
    std::array<int, 4> corners{base, base | across, base | across | up, base | up};
    if (face % 2 == 0) std::swap(corners[1], corners[3]);
    return corners;
}

int edge_between(int one, int other) {
    const int along = one ^ other;
    return cube_edge(along == 1 ? 0 : along == 2 ? 1 : 2, one & other);
}

/// Lines in which the surface meets the cube's faces, linked to cycles. On a walk around each face,
/// a line starts at an edge where the walk leaves the inside, and ends at an edge where the walk
/// enters it. So each crossed edge is the start of one line and the end of one line.
struct FaceLines {
    std::array<int, 12> next{};  ///< edge where an edge's line ends; -1 if not crossed
    std::array<std::array<int, 2>, 6> from{};  ///< edges where the lines of each face start
    std::array<int, 6> count{};                ///< number of lines by face
};

/// Returns the lines. joined: the face on which opposite inside corners are joined, or -1.
FaceLines face_lines(int inside, int joined) {
    FaceLines lines;
    lines.next.fill(-1);
    for (int face = 0; face < 6; ++face) {
        const auto corners = face_corners(face);
        const auto is_inside = [&](int i) { return (inside >> corners[i % 4] & 1) != 0; };
        const auto edge = [&](int i) { return edge_between(corners[i % 4], corners[(i + 1) % 4]); };
        for (int i = 0; i < 4; ++i) {
            if (!is_inside(i) || is_inside(i + 1)) continue;
            // The line goes around the inside corners before this edge. On the face `joined` it
            // goes around the outside corners after this edge.
            int end = face == joined ? i + 1 : i + 3;
            const int step = face == joined ? 1 : 3;
            while (is_inside(end) || !is_inside(end + 1))
                end += step;
            lines.next[edge(i)] = edge(end);
            lines.from[face][lines.count[face]++] = edge(i);
        }
    }
    return lines;
}

DualCase traced_case(int inside, int joined) {
    const FaceLines lines = face_lines(inside, joined);
    DualCase result;
    result.loop_of_edge.fill(-1);
    for (int edge = 0; edge < 12; ++edge) {
        if (lines.next[edge] < 0 || result.loop_of_edge[edge] >= 0) continue;
        for (int at = edge; result.loop_of_edge[at] < 0; at = lines.next[at])
            result.loop_of_edge[at] = result.loops;
        ++result.loops;
    }
    for (int face = 0; face < 6; ++face) {
        const auto& [one, other] = lines.from[face];
        if (lines.count[face] < 2 || result.loop_of_edge[one] != result.loop_of_edge[other])
            continue;
        ITEM3D_CHECK(result.doubled_face == no_face, "a cube has one doubled face at most");
        result.doubled_face = face;
    }
    return result;
}

struct CaseTable {
    CaseTable() {
        for (int inside = 0; inside < 256; ++inside) {
            plain[inside] = turned[inside] = traced_case(inside, no_face);
            const int face = plain[inside].doubled_face;
            if (face != no_face) turned[inside] = traced_case(inside, face);
        }
    }
    std::array<DualCase, 256> plain, turned;
};

}  // namespace

std::array<int, 2> cube_edge_ends(int edge) {
    const int axis = edge / 4, rank = edge % 4;
    const int lower = axis == 0 ? rank << 1 : axis == 1 ? (rank & 1) | (rank >> 1 << 2) : rank;
    return {lower, lower | 1 << axis};
}

const DualCase& dual_case(int inside, bool turned) {
    static const CaseTable table;
    return turned ? table.turned[inside] : table.plain[inside];
}

}  // namespace item3d
