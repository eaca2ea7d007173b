// Materials that are patterns: what the prior finds hardest, so cells are large and edges soft
// enough to survive 64 pixels.
#include "item3d/prior/material_tools.h"
#include "item3d/prior/noise.h"

namespace item3d::paint {

ProceduralMaterial stripes(Random& random, const MaterialWish& wish) {
    const auto [first, second] = two_colors(random, wish);
    Vec3 axis(0.0f);
    axis[random.chance(.6) ? 1 : random.chance(.5) ? 0 : 2] = 1.0f;
    if (random.chance(.25)) {
        axis += Vec3{random.normal(0, .5), random.normal(0, .5), random.normal(0, .5)};
    }
    axis = glm::normalize(axis);
    const float frequency = draw(random, 1.8, 4.2), shift = draw(random, 0, 1);
    const Vec3 a = vary(random, color_named(first)), b = vary(random, color_named(second));
    const float roughness = draw(random, .3, .8);
    return {"striped",
            first,
            {first + " and " + second + " striped {o}", first + " and " + second + " striped {o}",
             "striped " + first + " and " + second + " {o}", "striped {o}", "striped {o}",
             "{o} with " + first + " and " + second + " stripes", "{o} with stripes"},
            [=](const Vec3& p, const Vec3&) {
                const float s = fraction(glm::dot(p, axis) * frequency + shift);
                return MaterialValue{mix(a, b, smooth_step(std::abs(s - .5f), .235f, .265f)),
                                     roughness, 0};
            }};
}

ProceduralMaterial checks(Random& random, const MaterialWish& wish) {
    const auto [first, second] = two_colors(random, wish);
    const float frequency = draw(random, 1.6, 3.4);
    const Vec3 shift{draw(random, 0, 1), draw(random, 0, 1), draw(random, 0, 1)};
    const bool flat = random.chance(.6);
    const Vec3 a = vary(random, color_named(first)), b = vary(random, color_named(second));
    const float roughness = draw(random, .3, .8);
    return {
        "checkered",
        first,
        {first + " and " + second + " checkered {o}", first + " and " + second + " checkered {o}",
         "checkered " + first + " and " + second + " {o}", "checkered {o}", "checkered {o}",
         "{o} with a " + first + " and " + second + " checkerboard pattern",
         "{o} with a checkerboard pattern"},
        [=](const Vec3& p, const Vec3& n) {
            const Vec3 q = p * frequency + shift;
            const Vec2 uv = flat_coordinates(q, n);
            const float sum = flat ? std::floor(uv.x) + std::floor(uv.y)
                                   : std::floor(q.x) + std::floor(q.y) + std::floor(q.z);
            const bool odd = fraction(sum * .5f) > .25f;
            return MaterialValue{odd ? b : a, roughness, 0};
        }};
}

ProceduralMaterial dots(Random& random, const MaterialWish& wish) {
    const auto [first, second] = two_colors(random, wish);
    const float frequency = draw(random, 1.8, 3.6), size = draw(random, .24, .33);
    const Vec3 shift{draw(random, 0, 1), draw(random, 0, 1), draw(random, 0, 1)};
    const Vec3 a = vary(random, color_named(first)), b = vary(random, color_named(second));
    const float roughness = draw(random, .3, .8);
    return {
        "dots",
        first,
        {first + " {o} with " + second + " polka dots", first + " {o} with " + second + " dots",
         first + " and " + second + " polka dot {o}", "polka dot {o}", "polka dot {o}",
         "{o} with polka dots", "{o} with " + second + " dots"},
        [=](const Vec3& p, const Vec3& n) {
            const Vec2 uv = flat_coordinates(p * frequency + shift, n);
            const float row = std::floor(uv.y);
            const float u = uv.x + (fraction(row * .5f) > .25f ? .5f : 0.0f);
            const float d = std::hypot(fraction(u) - .5f, uv.y - row - .5f);
            return MaterialValue{mix(b, a, smooth_step(d, size - .02f, size + .03f)), roughness, 0};
        }};
}

ProceduralMaterial zebra(Random& random) {
    const Vec3 axis{1 + random.normal(0, .4), .3 + random.normal(0, .4), random.normal(0, .4)};
    const float frequency = draw(random, 12, 18);
    const CosineNoise warp(random, 3);
    const float roughness = draw(random, .4, .8);
    return {"zebra",
            "",
            {"zebra {o}", "{o} with zebra stripes", "zebra striped {o}", "zebra print {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float s = std::sin(glm::dot(p, axis) * frequency + 1.6f * warp(p));
                return MaterialValue{
                    mix({.015f, .015f, .015f}, {.82f, .8f, .76f}, smooth_step(s, -.15f, .15f)),
                    roughness, 0};
            }};
}

ProceduralMaterial leopard(Random& random) {
    const CosineNoise spots(random, draw(random, 11, 14));
    const Vec3 fur = vary(random, {.62f, .36f, .1f});
    return {"leopard",
            "",
            {"leopard {o}", "{o} with leopard spots", "leopard print {o}", "leopard print {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float v = spots(p);
                const float ring =
                    smooth_step(v, .5f, .7f) * (1 - .75f * smooth_step(v, 1.35f, 1.5f));
                return MaterialValue{mix(fur, {.03f, .018f, .01f}, ring), .8f, 0};
            }};
}

ProceduralMaterial flames(Random& random) {
    const CosineNoise flicker(random, 4, 2);
    const float roughness = draw(random, .3, .7);
    return {
        "flames",
        "",
        {"{o} with a flame pattern", "{o} with flames", "{o} painted with flames"},
        [=](const Vec3& p, const Vec3&) {
            const float h = p.y * 1.2f + .5f * flicker(p);
            const Vec3 hot = mix({.85f, .18f, .01f}, {.12f, .01f, .01f}, smooth_step(h, .2f, .9f));
            return MaterialValue{mix({.95f, .75f, .08f}, hot, smooth_step(h, -.7f, .2f)), roughness,
                                 0};
        }};
}

ProceduralMaterial brick(Random& random) {
    const float size = draw(random, 2.2, 3.6);
    const Vec3 light = vary(random, {.42f, .1f, .05f}), dark = vary(random, {.25f, .06f, .035f});
    const Vec3 mortar = vary(random, {.5f, .48f, .44f}, .08);
    return {"brick",
            "",
            {"brick {o}", "brick {o}", "{o} made of bricks", "{o} made of brick"},
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n) * size;
                const float row = std::floor(uv.y * 2);
                const float u = uv.x + (fraction(row * .5f) > .25f ? .5f : 0.0f);
                const float shade =
                    fraction(std::sin(row * 12.9898f + std::floor(u) * 78.233f) * 43.7585f);
                const bool joint = fraction(u) < .085f || uv.y * 2 - row < .17f;
                return MaterialValue{joint ? mortar : mix(light, dark, shade), .9f, 0};
            }};
}

}  // namespace item3d::paint
