#include "item3d/reconstruct/dataset/placement.h"

#include "item3d/core/format.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

constexpr float noticeable = 0.02f, near_unit = 0.1f;

struct Unit {
    const char* name;
    double metres;
};

constexpr Unit units[] = {
    {"metres", 1},    {"centimetres", 0.01}, {"millimetres", 0.001},    {"inches", 0.0254},
    {"feet", 0.3048}, {"decimetres", 0.1},   {"micrometres", 0.000001}, {"kilometres", 1000}};

std::vector<NamedTurn> axis_turns() {
    std::vector<NamedTurn> single;
    for (const int degrees : {90, -90, 180}) {
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 about(0.0f);
            about[axis] = 1;
            Mat3 matrix(glm::rotate(Mat4(1.0f), glm::radians(static_cast<float>(degrees)), about));
            for (int c = 0; c < 3; ++c)
                matrix[c] = glm::round(matrix[c]);
            single.push_back({matrix, fmt::format("{} degrees about {}", degrees, "xyz"[axis])});
        }
    }
    std::vector<NamedTurn> turns{{Mat3(1.0f), ""}};
    const auto add = [&](const NamedTurn& turn) {
        if (std::none_of(turns.begin(), turns.end(),
                         [&](const NamedTurn& t) { return t.matrix == turn.matrix; }))
            turns.push_back(turn);
    };
    for (const NamedTurn& turn : single)
        add(turn);
    for (const NamedTurn& first : single)
        for (const NamedTurn& second : single)
            add({second.matrix * first.matrix, first.words + ", then " + second.words});
    return turns;
}

}  // namespace

Mat4 Placement::matrix() const {
    Mat4 result(scale * turn);
    result[3] = Vec4(move, 1);
    return result;
}

std::vector<NamedTurn> turns_to_try(const Mat3& world_from_dataset) {
    std::vector<NamedTurn> turns = axis_turns();
    const auto near = [&](const NamedTurn& turn) {
        float apart = 0;
        for (int c = 0; c < 3; ++c)
            apart += glm::length(turn.matrix[c] - world_from_dataset[c]);
        return apart < 1e-3f;
    };
    if (std::none_of(turns.begin(), turns.end(), near)) {
        const Mat3& m = world_from_dataset;
        const Vec3 twice(m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]);
        const float angle = std::atan2(glm::length(twice), m[0][0] + m[1][1] + m[2][2] - 1);
        const Vec3 axis = glm::length(twice) > 1e-6f ? glm::normalize(twice) : Vec3(0.0f);
        turns.push_back({m, fmt::format("{:.1f} degrees about ({:.3f}, {:.3f}, {:.3f}), the "
                                        "rotation of the dataset's coordinates",
                                        glm::degrees(angle), axis.x, axis.y, axis.z)});
    }
    return turns;
}

std::vector<NamedScale> scales_near(float about) {
    std::vector<NamedScale> scales;
    const auto apart = [&](double factor) { return std::abs(std::log(factor / about)); };
    for (const Unit& mesh : units) {
        for (const Unit& photographs : units) {
            const double factor = mesh.metres / photographs.metres;
            const bool is_known = std::any_of(scales.begin(), scales.end(), [&](const auto& s) {
                return std::abs(s.factor / factor - 1) < 1e-3;
            });
            if (factor == 1 || is_known || !(apart(factor) < std::log1p(near_unit))) continue;
            scales.push_back(
                {static_cast<float>(factor),
                 fmt::format("{:.4g} ({} in {})", factor, mesh.name, photographs.name)});
        }
    }
    std::sort(scales.begin(), scales.end(),
              [&](const auto& a, const auto& b) { return apart(a.factor) < apart(b.factor); });
    return scales;
}

std::string placement_words(const Placement& placement, const std::string& turn,
                            const std::string& scale, float size) {
    std::string words = turn.empty() ? "" : "rotated by " + turn;
    if (std::abs(placement.scale - 1) > noticeable)
        words += (words.empty() ? "" : ", ") + ("scaled by " + scale);
    if (glm::length(placement.move) > noticeable * size) {
        words += fmt::format("{}moved by ({:.3g}, {:.3g}, {:.3g})", words.empty() ? "" : ", then ",
                             placement.move.x, placement.move.y, placement.move.z);
    }
    return words;
}

}  // namespace item3d
