#include "item3d/scene/flat_normals.h"

#include <cmath>

namespace item3d {

std::vector<std::uint32_t> make_flat(Primitive& primitive) {
    using DVec3 = glm::dvec3;
    std::vector<std::uint32_t> sources = primitive.indices;
    // The triangles of mirrored nodes were turned over when they were read.
    for (std::size_t t = 0; primitive.is_mirrored && t < sources.size(); t += 3)
        std::swap(sources[t + 1], sources[t + 2]);

    const auto gather = [&](auto& values) {
        auto old = std::move(values);
        values.clear();
        if (old.empty()) return;
        values.reserve(sources.size());
        for (const std::uint32_t vertex : sources)
            values.push_back(old[vertex]);
    };
    gather(primitive.positions);
    gather(primitive.uvs);
    gather(primitive.colors);
    primitive.tangents.clear();
    primitive.normals.clear();
    for (std::size_t t = 0; t < sources.size(); t += 3) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t corner = primitive.is_mirrored ? (3 - k) % 3 : k;
            primitive.indices[t + k] = static_cast<std::uint32_t>(t + corner);
        }
        const auto at = [&](std::size_t k) {
            return DVec3(primitive.positions[primitive.indices[t + k]]);
        };
        const DVec3 normal = glm::cross(at(1) - at(0), at(2) - at(0));
        const double length = glm::length(normal);
        // A triangle without area is not seen from any side.
        const bool has_area = std::isfinite(length) && length > 0.0;
        primitive.normals.insert(primitive.normals.end(), 3,
                                 has_area ? Vec3(normal / length) : Vec3(0.0f, 0.0f, 1.0f));
    }
    return sources;
}

}  // namespace item3d
