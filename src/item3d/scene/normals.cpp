#include "item3d/scene/normals.h"

#include "item3d/core/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace item3d {

namespace {

/// Numbers the positions from 0, and returns the number of each vertex's position.
std::vector<std::uint32_t> number_places(std::span<const Vec3> positions) {
    const auto key = [&](std::uint32_t i) {
        return std::array{positions[i].x, positions[i].y, positions[i].z};
    };
    std::vector<std::uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const auto left = key(a);
        const auto right = key(b);
        return left != right ? left < right : a < b;
    });
    std::vector<std::uint32_t> place(positions.size());
    std::uint32_t places = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && key(order[i]) != key(order[i - 1])) ++places;
        place[order[i]] = places;
    }
    return place;
}

}  // namespace

CornerNormals grouped_normals(std::span<const Vec3> positions,
                              std::span<const std::uint32_t> indices,
                              std::span<const std::int64_t> groups) {
    using DVec3 = glm::dvec3;
    const std::vector<std::uint32_t> place = number_places(positions);
    struct Key {
        std::uint32_t place;
        std::int64_t group;
        bool operator==(const Key&) const = default;
    };
    const auto hash = [](const Key& key) {
        return mix_bits(mix_bits(key.place) ^ static_cast<std::uint64_t>(key.group));
    };
    std::unordered_map<Key, std::uint32_t, decltype(hash)> numbers(0, hash);
    std::vector<DVec3> sums;
    CornerNormals result;
    result.corners.reserve(indices.size());
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
        const DVec3 a(positions[indices[t]]);
        const DVec3 b(positions[indices[t + 1]]);
        const DVec3 c(positions[indices[t + 2]]);
        // Twice the area times the unit normal.
        const DVec3 face = glm::cross(b - a, c - a);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [entry, is_new] = numbers.try_emplace(
                Key{place[indices[t + k]], groups[t / 3]}, static_cast<std::uint32_t>(sums.size()));
            if (is_new) sums.emplace_back(0.0);
            sums[entry->second] += face;
            result.corners.push_back(entry->second);
        }
    }
    for (const DVec3& sum : sums) {
        const double length = glm::length(sum);
        result.normals.push_back(length > 0.0 ? Vec3(sum / length) : Vec3(0.0f, 0.0f, 1.0f));
    }
    return result;
}

std::vector<Vec3> smooth_normals(std::span<const Vec3> positions,
                                 std::span<const std::uint32_t> indices) {
    using DVec3 = glm::dvec3;
    const std::vector<std::uint32_t> place = number_places(positions);
    const std::uint32_t places =
        place.empty() ? 0 : *std::max_element(place.begin(), place.end()) + 1;
    std::vector<DVec3> sums(places, DVec3(0.0));
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
        const DVec3 a(positions[indices[t]]);
        const DVec3 b(positions[indices[t + 1]]);
        const DVec3 c(positions[indices[t + 2]]);
        // Twice the area times the unit normal.
        const DVec3 face = glm::cross(b - a, c - a);
        for (int k = 0; k < 3; ++k)
            sums[place[indices[t + k]]] += face;
    }
    std::vector<Vec3> normals(positions.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const DVec3 sum = sums[place[i]];
        const double length = glm::length(sum);
        normals[i] = length > 0.0 ? Vec3(sum / length) : Vec3(0.0f, 0.0f, 1.0f);
    }
    return normals;
}

std::vector<std::uint32_t> make_flat(Primitive& primitive) {
    using DVec3 = glm::dvec3;
    std::vector<std::uint32_t> sources = primitive.indices;
    // The triangles of mirrored nodes were reversed when they were read. This restores the file's
    // order.
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
    for (std::vector<Vec2>& uvs : primitive.further_uvs)
        gather(uvs);
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
        // A triangle without area is invisible.
        const bool has_area = std::isfinite(length) && length > 0.0;
        primitive.normals.insert(primitive.normals.end(), 3,
                                 has_area ? Vec3(normal / length) : Vec3(0.0f, 0.0f, 1.0f));
    }
    return sources;
}

}  // namespace item3d
