#include "item3d/prior/data/materials/stones.h"

namespace item3d::paint {
namespace {

ProceduralMaterial marble(Random& random, const MaterialWish&) {
    const CosineNoise veins(random, 3, 3);
    const float sharpness = draw(random, 2.5, 5);
    const double which = random.uniform();
    const char* tone = which < .65 ? "white" : which < .85 ? "black" : "green";
    const bool pale = which < .65;
    const Vec3 body = pale          ? vary(random, {.8f, .79f, .77f}, .04)
                      : which < .85 ? vary(random, {.03f, .03f, .035f})
                                    : vary(random, {.03f, .12f, .07f});
    const Vec3 vein = pale ? Vec3(.16f, .16f, .18f) : Vec3(.6f, .58f, .55f);
    const float roughness = draw(random, .12, .3);
    const std::string toned = std::string(tone) + " marble";
    std::vector<std::string> phrases{"marble {o}", "marble {o}", "{o} made of marble",
                                     toned + " {o}"};
    if (!pale) phrases = {toned + " {o}", toned + " {o}", "{o} made of " + toned, "marble {o}"};
    return {"", "", phrases, [=](const Vec3& p, const Vec3&) {
                const float w = .85f * std::exp(-std::abs(veins(p)) * sharpness);
                return MaterialValue{mix(body, vein, w), roughness, 0};
            }};
}

/// Crystals of three tones.
ProceduralMaterial granite(Random& random, const MaterialWish&) {
    const bool rosy = random.chance(.4);
    const Vec3 main = rosy ? vary(random, {.5f, .28f, .22f}) : vary(random, {.4f, .4f, .39f});
    const float size = draw(random, 8.5, 11), roughness = draw(random, .15, .4);
    return {"",
            "",
            {"granite {o}", "granite {o}", "{o} made of granite", "speckled granite {o}"},
            [=](const Vec3& p, const Vec3&) {
                const NearPoints near = near_points(p * size);
                const Vec3 color = near.value < .2f    ? Vec3(.07f, .07f, .075f)
                                   : near.value < .45f ? Vec3(.66f, .64f, .61f)
                                                       : main * (.75f + .5f * near.value);
                return MaterialValue{limit(color), roughness, 0};
            }};
}

ProceduralMaterial stone(Random& random, const MaterialWish&) {
    const Vec3 dark = vary(random, {.17f, .165f, .155f}), light = vary(random, {.33f, .315f, .29f});
    return {"",
            "",
            {"stone {o}", "stone {o}", "{o} made of stone", "rock {o}", "{o} carved from rock"},
            grained(random, {.dark = dark,
                             .light = light,
                             .frequency = draw(random, 6, 10),
                             .octaves = 3,
                             .spread = 1.5f,
                             .rough_dark = .92f,
                             .rough_light = .92f,
                             .relief = .3f})};
}

ProceduralMaterial concrete(Random& random, const MaterialWish&) {
    const CosineNoise clouds(random, 3, 3);
    const Vec3 tone = vary(random, {.4f, .39f, .37f}, .08);
    const float pores = draw(random, 3.5, 5);
    return {"",
            "",
            {"concrete {o}", "concrete {o}", "{o} made of concrete", "cement {o}"},
            [=](const Vec3& p, const Vec3&) {
                const NearPoints near = near_points(p * pores);
                const bool pore = near.value > .55f && near.first < .17f;
                return MaterialValue{limit(tone * (pore ? .4f : 1 + .09f * clouds(p))), .9f, 0};
            }};
}

/// Round stones in mortar, in rows.
ProceduralMaterial cobblestone(Random& random, const MaterialWish&) {
    const Vec3 tone = vary(random, {.3f, .29f, .27f}), mortar = vary(random, {.06f, .055f, .05f});
    return {"",
            "",
            {"cobblestone {o}", "cobblestone {o}", "{o} made of cobblestones"},
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n) * cells_a_unit;
                const float row = std::floor(uv.y);
                const float u = uv.x + (odd(row) ? .5f : 0.0f);
                const Vec2 q(fraction(u) * 2 - 1, (uv.y - row) * 2 - 1);
                const float r = q.x * q.x * q.x * q.x + q.y * q.y * q.y * q.y;
                const float w = 1 - smooth_step(r, .15f, .45f);
                const float value = cell_value(std::floor(u), row);
                return MaterialValue{mix(mortar, tone * (.7f + .6f * value), w), .85f, 0,
                                     flat_slope(q * (.7f * w), n)};
            }};
}

ProceduralMaterial brick(Random& random, const MaterialWish&) {
    constexpr float size = 1.5f;
    const Vec3 light = vary(random, {.42f, .1f, .05f}), dark = vary(random, {.25f, .06f, .035f});
    const Vec3 mortar = vary(random, {.5f, .48f, .44f}, .08);
    return {"",
            "",
            {"brick {o}", "brick {o}", "{o} made of bricks", "{o} made of brick"},
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n) * size;
                const float row = std::floor(uv.y * 2);
                const float u = uv.x + (odd(row) ? .5f : 0.0f);
                const float across = fraction(u), up = uv.y * 2 - row;
                const bool joint = across < .12f || up < .24f;
                // The edges beside the joints are rounded.
                const Vec2 slope(across < .2f    ? -.5f
                                 : across > .93f ? .5f
                                                 : 0.0f,
                                 up < .36f   ? -.5f
                                 : up > .88f ? .5f
                                             : 0.0f);
                return MaterialValue{
                    joint ? mortar : mix(light, dark, cell_value(std::floor(u), row)), .9f, 0,
                    joint ? Vec3(0.0f) : flat_slope(slope, n)};
            }};
}

ProceduralMaterial terracotta(Random& random, const MaterialWish&) {
    const Vec3 clay = vary(random, {.52f, .2f, .095f}, .08);
    return {"",
            "",
            {"terracotta {o}", "terracotta {o}", "{o} made of terracotta", "clay {o}",
             "unglazed clay {o}"},
            grained(random, {.dark = clay * .72f,
                             .light = limit(clay * 1.15f),
                             .frequency = draw(random, 4, 7),
                             .stretch = {.5f, 2, .5f}})};
}

}  // namespace

std::vector<MaterialKind> stone_materials() {
    return {{"marble", .05, marble, {material_word("marble", "marble")}},
            {"granite", .02, granite, {material_word("granite", "granite")}},
            {"stone", .035, stone, {material_word("stone", "stone", {"stone", "rock"})}},
            {"concrete",
             .015,
             concrete,
             {material_word("concrete", "concrete", {"concrete", "cement"})}},
            {"cobblestone",
             .035,
             cobblestone,
             {material_word("cobblestone", "cobblestone", {"cobblestone", "cobblestones"})}},
            {"brick", .03, brick, {material_word("brick", "brick", {"brick", "bricks"})}},
            {"terracotta",
             .02,
             terracotta,
             {material_word("terracotta", "terracotta", {"terracotta", "clay"})}}};
}

}  // namespace item3d::paint
