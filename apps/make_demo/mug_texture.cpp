#include "apps/make_demo/mug.h"
#include "item3d/core/parallel.h"
#include "item3d/core/random.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace item3d::demo {

namespace {

float hash(glm::ivec3 cell, std::uint64_t seed) {
    const std::uint64_t key = mix_bits(static_cast<std::uint32_t>(cell.x)) ^
                              mix_bits(static_cast<std::uint32_t>(cell.y) + 0x100000000ull) ^
                              mix_bits(static_cast<std::uint32_t>(cell.z) + 0x200000000ull);
    return static_cast<float>(mix_bits(key ^ mix_bits(seed)) >> 40) * 0x1.0p-24f;
}

/// Returns smooth noise in [0, 1] with one value per unit of p.
float noise(Vec3 p, std::uint64_t seed) {
    const Vec3 base = glm::floor(p);
    const Vec3 f = glm::smoothstep(Vec3(0), Vec3(1), p - base);
    const glm::ivec3 cell(base);
    const auto edge = [&](int y, int z) {
        return glm::mix(hash(cell + glm::ivec3(0, y, z), seed),
                        hash(cell + glm::ivec3(1, y, z), seed), f.x);
    };
    return glm::mix(glm::mix(edge(0, 0), edge(1, 0), f.y), glm::mix(edge(0, 1), edge(1, 1), f.y),
                    f.z);
}

/// Returns 1 inside random specks in space, else 0, with a soft edge of half a texel.
float specks(Vec3 position, float cell_size, float density, std::uint64_t seed) {
    const Vec3 p = position / cell_size;
    const glm::ivec3 cell(glm::floor(p));
    float strongest = 0;
    for (int i = 0; i < 27; ++i) {
        const glm::ivec3 near = cell + glm::ivec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (hash(near, seed) > density) continue;
        const Vec3 centre =
            Vec3(near) + Vec3(hash(near, seed + 1), hash(near, seed + 2), hash(near, seed + 3));
        const float radius = 0.10f + 0.22f * hash(near, seed + 4) * hash(near, seed + 5);
        const float distance = glm::distance(p, centre);
        strongest = std::max(strongest, 1 - glm::smoothstep(0.6f * radius, radius, distance));
    }
    return strongest;
}

struct Paint {
    Vec3 color;  ///< sRGB
    Vec3 orm;
};

Paint paint_point(const SkinPoint& point) {
    const Vec3 p = point.position;
    const float height = p.y / 0.095f;

    // Molten glaze flows down. It is thin at the rim, and thick and darker towards the foot.
    const float flow = noise(Vec3(p.x * 60, p.y * 9, p.z * 60), 11);
    const float cloud = noise(p * 38.0f, 12) * 0.65f + noise(p * 90.0f, 13) * 0.35f;
    const float thick =
        std::clamp(0.55f + 0.30f * (flow - 0.5f) - 0.18f * (height - 0.5f), 0.0f, 1.0f);
    Vec3 glaze = glm::mix(Vec3(0.800f, 0.135f, 0.105f), Vec3(0.640f, 0.065f, 0.075f), thick);
    glaze *= 0.955f + 0.09f * cloud;

    const float ragged = 0.0010f * (noise(Vec3(p.x, 0, p.z) * 160.0f, 14) - 0.5f);
    const float rim = glm::smoothstep(0.0930f, 0.0949f, p.y + ragged);
    glaze = glm::mix(glaze, Vec3(0.760f, 0.275f, 0.165f), 0.60f * rim * (1 - point.handle));

    const float speck = specks(p, 0.0040f, 0.10f, 20);
    glaze = glm::mix(glaze, Vec3(0.270f, 0.055f, 0.050f), 0.75f * speck);
    float roughness = 0.20f + 0.05f * cloud + 0.10f * speck + 0.06f * rim;

    // The wiped foot ring shows the clay, and the glaze ends in an uneven line on both sides.
    const float edge = 0.0012f * (noise(Vec3(p.x, 0, p.z) * 220.0f, 15) - 0.5f);
    const float s = point.underside + edge;
    const float bare = point.underside < 0 ? 0.0f
                                           : glm::smoothstep(0.0262f, 0.0268f, s) *
                                                 (1 - glm::smoothstep(0.0345f, 0.0352f, s));
    const float grain = noise(p * 900.0f, 16) * 0.6f + noise(p * 1900.0f, 17) * 0.4f;
    const Vec3 clay = Vec3(0.800f, 0.690f, 0.560f) * (0.90f + 0.14f * grain);
    const Vec3 color = glm::mix(glaze, clay, bare);
    roughness = glm::mix(roughness, 0.86f, bare);

    // Less light reaches deeper points of the inside, and the underside only gets light through a
    // slit.
    float occlusion = 1;
    if (point.inside > 0) occlusion = 0.42f + 0.58f * glm::smoothstep(0.0f, 1.0f, height);
    if (point.underside >= 0) occlusion = glm::mix(0.35f, 0.8f, bare);
    // At the handle's ends the handle and the wall shade each other.
    const float radius = std::hypot(p.x, p.z);
    if (point.handle > 0) occlusion *= 0.72f + 0.28f * glm::smoothstep(0.0410f, 0.0520f, radius);
    return {color, Vec3(occlusion, roughness, 0)};
}

}  // namespace

MugTextures paint(const Mug& mug, int size) {
    MugTextures textures{Image(size, size, 3), Image(size, size, 3)};
    parallel_for("paint mug", static_cast<std::int64_t>(size) * size, [&](std::int64_t texel) {
        const int x = static_cast<int>(texel % size);
        const int y = static_cast<int>(texel / size);
        const Paint value =
            paint_point(mug.skin(Vec2(x + 0.5f, y + 0.5f) / static_cast<float>(size)));
        for (int c = 0; c < 3; ++c) {
            textures.base_color.at(x, y, c) = value.color[c];
            textures.orm.at(x, y, c) = value.orm[c];
        }
    });
    return textures;
}

Model make_mug(int texture_size) {
    const Mug mug;
    MugTextures painted = paint(mug, texture_size);
    Model model;
    model.name = "mug";
    model.primitives = {mug.primitive()};
    model.textures.resize(2);
    model.textures[0].name = "base_color";
    model.textures[0].image = std::move(painted.base_color);
    model.textures[1].name = "occlusion_roughness_metallic";
    model.textures[1].image = std::move(painted.orm);
    Material material;
    material.name = "glaze";
    material.base_color_texture = 0;
    material.metallic_roughness_texture = 1;
    material.occlusion_texture = 1;
    model.materials = {material};
    return model;
}

}  // namespace item3d::demo
