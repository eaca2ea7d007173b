#include "item3d/prior/data/materials/ornaments.h"

namespace item3d::paint {
namespace {

/// Flowers of five petals on leaves, one in each cell of an irregular lattice.
ProceduralMaterial floral(Random& random, const MaterialWish& wish) {
    const bool named = !wish.color.empty() || random.chance(.6);
    const auto [first, second] =
        named ? two_colors(random, wish) : std::pair<std::string, std::string>("white", "pink");
    const Vec3 ground = vary(random, color_named(first)), petal = vary(random, color_named(second));
    const Vec3 core = second == "yellow" ? Vec3(.7f, .1f, .02f) : Vec3(.9f, .65f, .05f);
    const Wording words = wording(
        named,
        {first + " and " + second + " floral {o}", first + " {o} with " + second + " flowers"},
        {"floral {o}", "floral {o}", "{o} with a floral pattern", "flowery {o}",
         "{o} with flowers"});
    return {
        "", first, words.phrases,
        [=](const Vec3& p, const Vec3& n) {
            const Vec2 uv = flat_coordinates(p, n) * cells_a_unit;
            const float row = std::floor(uv.y);
            const float u = uv.x + (odd(row) ? .5f : 0.0f), column = std::floor(u);
            const Vec2 jitter(cell_value(column, row, 1) - .5f, cell_value(column, row, 2) - .5f);
            const Vec2 q(fraction(u) - .5f - .15f * jitter.x, uv.y - row - .5f - .15f * jitter.y);
            const float r = glm::length(q);
            const float angle = std::atan2(q.y, q.x) + 6 * cell_value(column, row);
            const float edge = .24f + .11f * std::cos(5 * angle);
            const float leaf = .4f * std::pow(std::max(std::cos(1.5f * angle), 0.0f), 3.0f);
            if (r < .1f) return MaterialValue{core, .6f, 0};
            if (r < edge) return MaterialValue{petal * (.6f + r), .6f, 0};
            if (r < leaf) return MaterialValue{{.04f, .2f, .03f}, .6f, 0};
            return MaterialValue{ground, .6f, 0};
        },
        words.also_true};
}

/// Blots of four tones. Like all patterns with borders, they have the same place on every object.
ProceduralMaterial camouflage(Random& random, const MaterialWish&) {
    const Vec3 black = vary(random, {.012f, .013f, .011f}, .08),
               green = vary(random, {.05f, .13f, .025f}, .08),
               brown = vary(random, {.15f, .065f, .025f}, .08),
               khaki = vary(random, {.46f, .38f, .19f}, .08);
    Random blots(2);
    const CosineNoise one(blots, 5, 1), two(blots, 5, 1);
    return {"",
            "",
            {"camouflage {o}", "camouflage {o}", "{o} with a camouflage pattern", "camo {o}",
             "{o} in camouflage"},
            [=](const Vec3& p, const Vec3&) {
                const float a = one(p), b = two(p);
                Vec3 tone = a > 0 ? green : khaki;
                if (b > .45f) tone = brown;
                if (b < -.85f) tone = black;
                return MaterialValue{tone, .9f, 0};
            }};
}

/// Dark cracks between dry plates.
ProceduralMaterial cracks(Random& random, const MaterialWish& wish) {
    const bool named = !wish.color.empty() || random.chance(.6);
    const std::string name = named ? one_color(random, wish) : "beige";
    const Vec3 color = vary(random, color_named(name));
    const Vec3 deep = name == "black" ? Vec3(.35f) : color * .06f;
    Random plates(1);
    const CosineNoise warp(plates, 6, 2);
    const Wording words = wording(named, {"cracked " + name + " {o}", name + " {o} with cracks"},
                                  {"cracked {o}", "{o} with cracks"});
    return {
        "", name, words.phrases,
        [=](const Vec3& p, const Vec3&) {
            const NearPoints near = near_points(p * cells_a_unit + .08f * warp(p));
            const float gap = near.second - near.first;
            const float w = smooth_step(gap, .12f, .24f);
            return MaterialValue{limit(mix(deep, color * (.9f + .2f * near.value), w)), .75f, 0};
        },
        words.also_true};
}

ProceduralMaterial flames(Random& random, const MaterialWish&) {
    const CosineNoise flicker(random, 4, 2);
    const float roughness = draw(random, .3, .7);
    return {
        "",
        "",
        {"flame patterned {o}", "{o} with a flame pattern", "{o} with flames",
         "{o} painted with flames"},
        [=](const Vec3& p, const Vec3&) {
            const float h = p.y * 1.2f + .5f * flicker(p);
            const Vec3 hot = mix({.85f, .18f, .01f}, {.12f, .01f, .01f}, smooth_step(h, .2f, .9f));
            return MaterialValue{mix({.95f, .75f, .08f}, hot, smooth_step(h, -.7f, .2f)), roughness,
                                 0};
        }};
}

}  // namespace

std::vector<MaterialKind> ornament_patterns() {
    return {
        {"floral",
         .05,
         floral,
         {colored(pattern_word("floral", "floral", {"floral", "flowers", "flowery"}),
                  "a {c} {o} with {d} flowers")}},
        {"camouflage",
         .03,
         camouflage,
         {pattern_word("camouflage", "camouflage", {"camouflage", "camo"})}},
        {"cracked",
         .05,
         cracks,
         {colored(pattern_word("cracked", "cracked", {"cracked", "cracks"}), "a cracked {c} {o}")}},
        {"flames",
         .02,
         flames,
         {word_of("patterns", "flames", "flames", {"flame", "flames"},
                  "a {o} with a flame pattern")}}};
}

}  // namespace item3d::paint
