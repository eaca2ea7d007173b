#include "item3d/prior/data/materials/nature.h"

namespace item3d::paint {
namespace {

ProceduralMaterial grass(Random& random, const MaterialWish&) {
    const CosineNoise patches(random, 9, 3), blades(random, 36, 1, {1, .35f, 1});
    const Vec3 dark = vary(random, {.02f, .08f, .01f}), light = vary(random, {.16f, .36f, .04f});
    return {"",
            "",
            {"grassy {o}", "{o} covered in grass", "{o} covered in grass", "{o} made of grass",
             "grass {o}"},
            [=](const Vec3& p, const Vec3&) {
                Vec3 gradient(0.0f);
                const float w =
                    smooth_step(patches(p) + .5f * blades.with_gradient(p, gradient), -1.4f, 1.4f);
                return MaterialValue{mix(dark, light, w), 1, 0, gradient * .014f};
            }};
}

/// Moss cushions on stone, thicker at the top.
ProceduralMaterial moss(Random& random, const MaterialWish&) {
    const CosineNoise cushions(random, 7, 2), tufts(random, 22);
    const Vec3 rock = vary(random, {.2f, .19f, .17f});
    const Vec3 dark = vary(random, {.03f, .06f, .008f}), light = vary(random, {.2f, .24f, .03f});
    return {"",
            "",
            {"mossy {o}", "mossy {o}", "{o} covered in moss", "moss covered {o}",
             "{o} overgrown with moss"},
            [=](const Vec3& p, const Vec3& n) {
                Vec3 gradient(0.0f);
                const float height = cushions.with_gradient(p, gradient);
                const float w = smooth_step(height + .9f * n.y, -.5f, .1f);
                const float tone = smooth_step(height + .5f * tufts(p), -1, 1.6f);
                return MaterialValue{mix(rock, mix(dark, light, tone), w), .95f, 0,
                                     gradient * (.07f * w)};
            }};
}

ProceduralMaterial snow(Random& random, const MaterialWish&) {
    const Vec3 below = vary(random, color_named(one_color(random, {})));
    const CosineNoise edge(random, 6, 2);
    return {"",
            "",
            {"snowy {o}", "{o} covered in snow", "{o} covered in snow", "snow covered {o}"},
            [=](const Vec3& p, const Vec3& n) {
                Vec3 gradient(0.0f);
                const float w =
                    smooth_step(n.y + .35f * edge.with_gradient(p, gradient), -.35f, .1f);
                return MaterialValue{mix(below, {.88f, .9f, .94f}, w), .5f + .4f * w, 0,
                                     gradient * (.05f * w)};
            }};
}

ProceduralMaterial ice(Random& random, const MaterialWish&) {
    const CosineNoise frost(random, 5, 3), cracks(random, 4, 2);
    return {"",
            "",
            {"icy {o}", "{o} made of ice", "ice {o}", "frozen {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float w = smooth_step(frost(p), -1, 1);
                const float crack = std::exp(-std::abs(cracks(p)) * 9);
                return MaterialValue{
                    limit(mix({.42f, .66f, .82f}, {.8f, .92f, .97f}, w) + .3f * crack),
                    .05f + .2f * w, 0};
            }};
}

/// Dark crust with glowing cracks. Training images have no emission, so the cracks have a bright
/// base colour instead.
ProceduralMaterial lava(Random& random, const MaterialWish&) {
    const float size = draw(random, 2, 3);
    const CosineNoise warp(random, 5);
    return {"",
            "",
            {"lava {o}", "lava {o}", "{o} made of lava", "molten lava {o}"},
            [=](const Vec3& p, const Vec3&) {
                const NearPoints near = near_points(p * size + .12f * warp(p));
                const float gap = near.second - near.first;
                const float heat = 1 - smooth_step(gap, .04f, .3f);
                const Vec3 glow = mix({.7f, .04f, .0f}, {1, .6f, .05f}, smooth_step(heat, .4f, 1));
                return MaterialValue{mix({.025f, .02f, .02f}, glow, smooth_step(heat, .1f, .5f)),
                                     .9f, 0};
            }};
}

ProceduralMaterial sand(Random& random, const MaterialWish&) {
    const CosineNoise grains(random, 38), warp(random, 3);
    const Vec3 tone = vary(random, {.72f, .55f, .33f}, .07);
    const float ripples = draw(random, 18, 24);
    return {"",
            "",
            {"sandy {o}", "{o} made of sand", "sand {o}", "{o} covered in sand"},
            [=](const Vec3& p, const Vec3&) {
                const float phase = p.y * ripples + 1.6f * warp(p);
                return MaterialValue{
                    limit(tone * (.92f + .1f * std::sin(phase) + .07f * grains(p))), 1, 0,
                    Vec3(0, .4f * std::cos(phase), 0)};
            }};
}

}  // namespace

std::vector<MaterialKind> nature_materials() {
    return {
        {"grass",
         .025,
         grass,
         {word_of("materials", "grass", "grass", {"grass", "grassy"}, "a {o} covered in grass")}},
        {"moss",
         .02,
         moss,
         {word_of("materials", "moss", "moss", {"moss", "mossy"}, "a {o} covered in moss")}},
        {"snow",
         .025,
         snow,
         {word_of("materials", "snow", "snow", {"snow", "snowy"}, "a {o} covered in snow")}},
        {"ice",
         .02,
         ice,
         {word_of("materials", "ice", "ice", {"ice", "icy", "frozen"}, "a {o} made of ice")}},
        {"lava", .015, lava, {material_word("lava", "lava", {"lava", "molten"})}},
        {"sand",
         .015,
         sand,
         {word_of("materials", "sand", "sand", {"sand", "sandy"}, "a {o} made of sand")}}};
}

}  // namespace item3d::paint
