#include "item3d/prior/data/materials/woods.h"

#include <array>

namespace item3d::paint {
namespace {

struct WoodLook {
    const char* name;  ///< "" for wood without a name in captions
    double share;
    std::array<float, 3> light, dark;
    float knots;  ///< fraction of the surface
};

constexpr std::array<WoodLook, 7> looks{
    {{"", .16, {.45f, .22f, .08f}, {.16f, .06f, .018f}, 0},
     {"", .16, {.58f, .36f, .16f}, {.27f, .12f, .035f}, 0},
     {"", .16, {.25f, .11f, .04f}, {.07f, .025f, .009f}, 0},
     {"oak", .14, {.52f, .33f, .15f}, {.19f, .09f, .03f}, 0},
     {"walnut", .14, {.15f, .07f, .03f}, {.045f, .02f, .01f}, 0},
     {"pine", .14, {.78f, .54f, .25f}, {.4f, .19f, .055f}, 1},
     {"ebony", .1, {.035f, .026f, .022f}, {.008f, .007f, .007f}, 0}}};

ProceduralMaterial wood(Random& random, const MaterialWish& wish) {
    double at = random.uniform();
    const WoodLook* look = &looks[0];
    for (const WoodLook& each : looks) {
        if (!wish.color.empty() ? wish.color == each.name : (at -= each.share) < 0) {
            look = &each;
            break;
        }
    }
    // Grain runs vertically, as in most wooden things. All boards have the same cut, with rings
    // nine pixels wide, so that the network can learn the place of the rings.
    Random trunk(1);
    const CosineNoise warp(trunk, 3, 2, {1, .4f, 1}), fiber(random, 30, 1, {1, .15f, 1});
    constexpr float rings = 3;
    const Vec3 light = vary(random, {look->light[0], look->light[1], look->light[2]}),
               dark = vary(random, {look->dark[0], look->dark[1], look->dark[2]});
    const float roughness = draw(random, .4, .75), knots = look->knots;
    const std::string name = look->name;
    std::vector<std::string> phrases{"wooden {o}", "wooden {o}", "wooden {o}", "{o} made of wood",
                                     "wood {o}"};
    if (!name.empty())
        phrases = {name + " {o}", name + " {o}", name + " wood {o}", "{o} made of " + name,
                   "wooden {o}"};
    return {"", name, phrases, [=](const Vec3& p, const Vec3& n) {
                float ring = fraction((flat_coordinates(p, n).x + .05f * warp(p)) * rings);
                float knot = 0;
                if (knots > 0) {
                    const NearPoints near = near_points(p * 1.6f);
                    knot = 1 - smooth_step(near.first, .1f, .2f);
                }
                ring = smooth_step(ring, 0, .85f) * (1 - smooth_step(ring, .85f, 1));
                const float w = std::clamp(.85f * ring + .15f * fiber(p) + .8f * knot, 0.0f, 1.0f);
                return MaterialValue{mix(light, dark, w), roughness, 0};
            }};
}

/// Jointed stems side by side.
ProceduralMaterial bamboo(Random& random, const MaterialWish&) {
    const Vec3 light = vary(random, {.72f, .6f, .25f}, .1), dark = light * Vec3(.45f, .5f, .4f);
    const float stems = draw(random, 3.2, 4.6), joints = draw(random, 1.1, 1.7);
    return {"",
            "",
            {"bamboo {o}", "bamboo {o}", "{o} made of bamboo"},
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n);
                const float stem = std::floor(uv.x * stems);
                const float across = fraction(uv.x * stems) * 2 - 1;
                const float along = fraction(uv.y * joints + cell_value(stem, 0) * .8f);
                const bool joint = along < .07f;
                const float gap = smooth_step(std::abs(across), .8f, 1);
                const Vec3 color = mix(light * (.85f + .25f * cell_value(stem, 3)), dark,
                                       std::max(gap, joint ? .75f : 0.0f));
                return MaterialValue{limit(color), .4f, 0, flat_slope({-across * .7f, 0}, n)};
            }};
}

}  // namespace

std::vector<MaterialKind> wood_materials() {
    std::vector<MaterialWord> words{
        word_of("materials", "wood", "wood", {"wood", "wooden"}, "a wooden {o}")};
    for (const char* name : {"oak", "walnut", "pine", "ebony"}) {
        words.push_back(material_word("wood", name));
        words.back().wish.color = name;
    }
    return {{"wood", .12, wood, words},
            {"bamboo", .015, bamboo, {material_word("bamboo", "bamboo")}}};
}

}  // namespace item3d::paint
