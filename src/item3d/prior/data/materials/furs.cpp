#include "item3d/prior/data/materials/furs.h"

namespace item3d::paint {
namespace {

ProceduralMaterial zebra(Random& random, const MaterialWish&) {
    const Vec3 axis{1 + random.normal(0, .4), .3 + random.normal(0, .4), random.normal(0, .4)};
    const float frequency = draw(random, 12, 18);
    const CosineNoise warp(random, 3);
    const float roughness = draw(random, .4, .8);
    return {"",
            "",
            {"zebra {o}", "{o} with zebra stripes", "zebra striped {o}", "zebra print {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float s = std::sin(glm::dot(p, axis) * frequency + 1.6f * warp(p));
                return MaterialValue{
                    mix({.015f, .015f, .015f}, {.82f, .8f, .76f}, smooth_step(s, -.15f, .15f)),
                    roughness, 0};
            }};
}

ProceduralMaterial leopard(Random& random, const MaterialWish&) {
    const CosineNoise spots(random, draw(random, 11, 14));
    const Vec3 fur = vary(random, {.62f, .36f, .1f});
    return {"",
            "",
            {"leopard print {o}", "leopard {o}", "{o} with leopard spots", "leopard print {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float v = spots(p);
                const float ring =
                    smooth_step(v, .5f, .7f) * (1 - .75f * smooth_step(v, 1.35f, 1.5f));
                return MaterialValue{mix(fur, {.03f, .018f, .01f}, ring), .8f, 0};
            }};
}

/// Orange fur with dark bands that taper and break off.
ProceduralMaterial tiger(Random& random, const MaterialWish&) {
    const CosineNoise warp(random, 3.5f), breaks(random, 5);
    const float frequency = draw(random, 13, 17);
    const Vec3 fur = vary(random, {.75f, .27f, .035f}, .08), pale(.85f, .72f, .55f);
    return {"",
            "",
            {"tiger {o}", "{o} with tiger stripes", "tiger striped {o}", "tiger print {o}"},
            [=](const Vec3& p, const Vec3& n) {
                const float s = std::sin(p.x * frequency + 1.8f * warp(p)) + .45f * breaks(p);
                const float band = smooth_step(s, .3f, .5f);
                const Vec3 coat = mix(fur, pale, smooth_step(-n.y, .2f, .8f) * .8f);
                return MaterialValue{mix(coat, {.02f, .015f, .012f}, band), .8f, 0};
            }};
}

/// Brown patches between pale lines.
ProceduralMaterial giraffe(Random& random, const MaterialWish&) {
    const Vec3 patch = vary(random, {.26f, .085f, .02f}, .1),
               line = vary(random, {.84f, .7f, .46f}, .05);
    return {"",
            "",
            {"giraffe {o}", "{o} with giraffe spots", "giraffe print {o}", "giraffe patterned {o}"},
            [=](const Vec3& p, const Vec3&) {
                const NearPoints near = near_points(p * cells_a_unit);
                const float w = smooth_step(near.second - near.first, .16f, .26f);
                return MaterialValue{mix(line, patch * (.8f + .4f * near.value), w), .8f, 0};
            }};
}

/// White fur with black spots of all sizes.
ProceduralMaterial dalmatian(Random& random, const MaterialWish&) {
    const Vec3 coat = vary(random, {.84f, .82f, .78f}, .03);
    return {"",
            "",
            {"dalmatian {o}", "{o} with dalmatian spots", "dalmatian print {o}"},
            [=](const Vec3& p, const Vec3&) {
                const NearPoints near = near_points(p * cells_a_unit);
                const float radius = .2f + .22f * near.value;
                const float w = smooth_step(near.first, radius - .03f, radius + .03f);
                return MaterialValue{mix({.015f, .014f, .014f}, coat, w), .75f, 0};
            }};
}

}  // namespace

std::vector<MaterialKind> fur_patterns() {
    return {{"zebra", .025, zebra, {pattern_word("zebra", "zebra")}},
            {"leopard",
             .025,
             leopard,
             {word_of("patterns", "leopard", "leopard", {"leopard"}, "a leopard print {o}")}},
            {"tiger", .02, tiger, {pattern_word("tiger", "tiger")}},
            {"giraffe", .03, giraffe, {pattern_word("giraffe", "giraffe")}},
            {"dalmatian", .02, dalmatian, {pattern_word("dalmatian", "dalmatian")}}};
}

}  // namespace item3d::paint
