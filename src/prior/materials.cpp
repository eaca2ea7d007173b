#include "item3d/prior/materials.h"

#include "item3d/core/error.h"
#include "item3d/prior/material_tools.h"
#include "item3d/prior/noise.h"

#include <array>

namespace item3d {

const std::vector<PlainColor>& plain_colors() {
    static const std::vector<PlainColor> colors{
        {"red", {.7f, .02f, .02f}},       {"green", {.03f, .42f, .05f}},
        {"blue", {.02f, .08f, .65f}},     {"yellow", {.85f, .65f, .02f}},
        {"orange", {.85f, .25f, .01f}},   {"purple", {.28f, .03f, .5f}},
        {"pink", {.85f, .3f, .45f}},      {"white", {.85f, .85f, .85f}},
        {"black", {.012f, .012f, .012f}}, {"gray", {.22f, .22f, .22f}},
        {"brown", {.16f, .06f, .02f}},    {"cyan", {.02f, .6f, .65f}}};
    return colors;
}

const std::vector<PlainColor>& metal_colors() {
    static const std::vector<PlainColor> colors{{"gold", {1.f, .63f, .18f}},
                                                {"silver", {.92f, .91f, .88f}},
                                                {"copper", {.92f, .42f, .26f}},
                                                {"bronze", {.5f, .3f, .11f}}};
    return colors;
}

namespace paint {

Vec3 color_named(const std::string& name) {
    for (const PlainColor& color : plain_colors())
        if (color.name == name) return color.linear;
    for (const PlainColor& color : metal_colors())
        if (color.name == name) return color.linear;
    ITEM3D_CHECK(false, "no colour is called " + name);
    return {};
}

std::pair<std::string, std::string> two_colors(Random& random, const MaterialWish& wish) {
    const auto& colors = plain_colors();
    const auto any = [&] {
        return colors[static_cast<std::size_t>(
                          random.index(static_cast<std::int64_t>(colors.size())))]
            .name;
    };
    // White is every pattern's favourite partner; it also keeps the two apart.
    std::string first = any(), second = random.chance(.3) ? "white" : any();
    if (!wish.color.empty()) first = wish.color;
    if (!wish.second_color.empty()) second = wish.second_color;
    while (second == first)
        second = any();
    return {first, second};
}

namespace {

ProceduralMaterial plain(Random& random, const MaterialWish& wish) {
    const std::string name = wish.color.empty() ? two_colors(random, wish).first : wish.color;
    const Vec3 color = vary(random, color_named(name));
    struct Finish {
        const char* word;
        double share, low, high;
    };
    static constexpr std::array<Finish, 6> finishes{{{"", .5, .3, .7},
                                                     {"matte", .1, .8, 1},
                                                     {"glossy", .1, .08, .2},
                                                     {"ceramic", .12, .1, .25},
                                                     {"plastic", .1, .25, .4},
                                                     {"shiny", .08, .08, .2}}};
    double at = random.uniform();
    const Finish* finish = &finishes[0];
    for (const Finish& each : finishes) {
        finish = &each;
        if ((at -= each.share) < 0) break;
    }
    const std::string word = finish->word;
    const float roughness = draw(random, finish->low, finish->high);
    const float mottled = random.chance(.25) ? .08f : 0.0f;
    const CosineNoise noise(random, draw(random, 3, 12));

    // "gray" and "grey" are one word to people.
    const std::string c = name == "gray" && random.chance(.2) ? "grey" : name;
    std::vector<std::string> phrases{word + " " + c + " {o}"};
    if (word.empty()) {
        phrases = {c + " {o}", c + " {o}", c + " {o}", "{o} painted " + c, "plain " + c + " {o}"};
    } else if (word == "plastic") {
        phrases = {c + " plastic {o}", "{o} made of " + c + " plastic"};
    } else if (word == "ceramic") {
        phrases = {c + " ceramic {o}", "ceramic " + c + " {o}"};
    }
    return {"plain", name, phrases, [=](const Vec3& p, const Vec3&) {
                const float shade = mottled > 0 ? 1 + mottled * noise(p) : 1.0f;
                return MaterialValue{limit(color * shade), roughness, 0};
            }};
}

ProceduralMaterial metal(Random& random, const MaterialWish& wish) {
    const double at = random.uniform();
    std::string name = at < .4 ? "gold" : at < .65 ? "silver" : at < .85 ? "copper" : "bronze";
    if (!wish.color.empty()) name = wish.color;
    const Vec3 color = vary(random, color_named(name), .05);
    const float roughness = draw(random, .1, .38);
    const std::string word = name == "gold" ? "golden" : name;
    std::vector<std::string> phrases{word + " {o}", word + " {o}", name + " {o}",
                                     "{o} made of " + name, "shiny " + word + " {o}"};
    if (name == "silver") phrases.push_back("metal {o}");
    return {"metal", name, phrases, [=](const Vec3&, const Vec3&) {
                return MaterialValue{color, roughness, 1};
            }};
}

ProceduralMaterial rust(Random& random) {
    const CosineNoise patches(random, draw(random, 4, 8), 3), grain(random, 20);
    const Vec3 iron = vary(random, {.25f, .22f, .2f});
    const Vec3 light = vary(random, {.35f, .1f, .02f}), dark = vary(random, {.12f, .04f, .02f});
    return {"rust",
            "",
            {"rusty {o}", "rusty metal {o}", "{o} made of rusty iron", "rusty iron {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float w = smooth_step(patches(p), -.6f, .6f);
                const Vec3 oxide = mix(light, dark, smooth_step(grain(p), -1, 1));
                return MaterialValue{mix(iron, oxide, w), .45f + .45f * w, 1 - w};
            }};
}

ProceduralMaterial wood(Random& random) {
    Vec3 axis{random.normal(0, .25), random.normal(0, .25), random.normal(0, .25)};
    axis[static_cast<int>(random.index(3))] += 1;
    axis = glm::normalize(axis);
    const Vec3 heart{random.normal(0, .5), random.normal(0, .5), random.normal(0, .5)};
    const CosineNoise warp(random, 3, 2, {1, .4f, 1}), fiber(random, 30, 1, {1, .15f, 1});
    // Rings of four to ten pixels: finer ones are lost in a picture of 64.
    const float rings = draw(random, 2.4, 5);
    static constexpr std::array<std::array<float, 6>, 3> palettes{
        {{.45f, .22f, .08f, .16f, .06f, .018f},
         {.58f, .36f, .16f, .27f, .12f, .035f},
         {.25f, .11f, .04f, .07f, .025f, .009f}}};
    const auto& k = palettes[static_cast<std::size_t>(random.index(3))];
    const Vec3 light = vary(random, {k[0], k[1], k[2]}), dark = vary(random, {k[3], k[4], k[5]});
    const float roughness = draw(random, .45, .75);
    return {"wood",
            "",
            {"wooden {o}", "wooden {o}", "wooden {o}", "{o} made of wood", "wood {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float along = glm::dot(p, axis);
                const Vec3 q = p - along * axis + heart;
                const float ring = fraction((glm::length(q) + .1f * warp(p)) * rings);
                const float late = smooth_step(ring, 0, .85f) * (1 - smooth_step(ring, .85f, 1));
                const float w = std::clamp(.75f * late + .15f * fiber(p), 0.0f, 1.0f);
                return MaterialValue{mix(light, dark, w), roughness, 0};
            }};
}

ProceduralMaterial marble(Random& random) {
    const CosineNoise veins(random, 3, 3);
    const float sharpness = draw(random, 2.5, 5);
    const bool white = random.chance(.75);
    const Vec3 body =
        white ? vary(random, {.8f, .79f, .77f}, .04) : vary(random, {.03f, .03f, .035f});
    const Vec3 vein = white ? Vec3(.16f, .16f, .18f) : Vec3(.6f, .58f, .55f);
    const float roughness = draw(random, .12, .3);
    std::vector<std::string> phrases{"marble {o}", "marble {o}", "{o} made of marble"};
    if (white)
        phrases.push_back("white marble {o}");
    else
        phrases = {"black marble {o}", "black marble {o}", "{o} made of black marble",
                   "marble {o}"};
    return {"marble", "", phrases, [=](const Vec3& p, const Vec3&) {
                const float w = .85f * std::exp(-std::abs(veins(p)) * sharpness);
                return MaterialValue{mix(body, vein, w), roughness, 0};
            }};
}

ProceduralMaterial stone(Random& random) {
    const CosineNoise grain(random, draw(random, 6, 10), 3);
    const Vec3 dark = vary(random, {.1f, .095f, .09f}), light = vary(random, {.36f, .34f, .31f});
    return {"stone",
            "",
            {"stone {o}", "stone {o}", "{o} made of stone", "rock {o}"},
            [=](const Vec3& p, const Vec3&) {
                return MaterialValue{mix(dark, light, smooth_step(grain(p), -1.5f, 1.5f)), .92f, 0};
            }};
}

ProceduralMaterial grass(Random& random) {
    const CosineNoise patches(random, 9, 3), blades(random, 40);
    const Vec3 dark = vary(random, {.02f, .08f, .01f}), light = vary(random, {.16f, .36f, .04f});
    return {"grass",
            "",
            {"{o} covered in grass", "grassy {o}", "mossy {o}", "{o} made of grass", "grass {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float w = smooth_step(patches(p) + .4f * blades(p), -1.4f, 1.4f);
                return MaterialValue{mix(dark, light, w), 1, 0};
            }};
}

ProceduralMaterial snow(Random& random) {
    const Vec3 below = vary(random, color_named(two_colors(random, {}).first));
    const CosineNoise edge(random, 6, 2);
    return {"snow", "", {"{o} covered in snow", "snowy {o}"}, [=](const Vec3& p, const Vec3& n) {
                const float w = smooth_step(n.y + .35f * edge(p), -.35f, .1f);
                return MaterialValue{mix(below, {.88f, .9f, .94f}, w), .5f + .4f * w, 0};
            }};
}

ProceduralMaterial ice(Random& random) {
    const CosineNoise frost(random, 5, 3);
    return {
        "ice", "", {"{o} made of ice", "ice {o}", "icy {o}"}, [=](const Vec3& p, const Vec3&) {
            const float w = smooth_step(frost(p), -1, 1);
            return MaterialValue{mix({.45f, .68f, .82f}, {.8f, .92f, .97f}, w), .08f + .15f * w, 0};
        }};
}

ProceduralMaterial leather(Random& random) {
    static constexpr std::array<std::array<float, 3>, 3> hides{
        {{.2f, .08f, .03f}, {.03f, .02f, .018f}, {.3f, .05f, .03f}}};
    const auto& hide = hides[static_cast<std::size_t>(random.index(3))];
    const CosineNoise grain(random, 30);
    const Vec3 light = vary(random, {hide[0], hide[1], hide[2]}), dark = light * .5f;
    return {"leather",
            "",
            {"leather {o}", "leather {o}", "{o} made of leather"},
            [=](const Vec3& p, const Vec3&) {
                const float w = smooth_step(grain(p), -.5f, 1.5f);
                return MaterialValue{mix(light, dark, w), .45f + .25f * w, 0};
            }};
}

struct Kind {
    const char* name;
    double share;
    ProceduralMaterial (*make)(Random&, const MaterialWish&);
};

template <ProceduralMaterial (*make)(Random&)>
ProceduralMaterial unwished(Random& random, const MaterialWish&) {
    return make(random);
}

/// Shares of the training data. Patterns have two fifths: they were learnt last in every trial.
constexpr std::array<Kind, 17> kinds{{{"plain", .26, plain},
                                      {"metal", .11, metal},
                                      {"wood", .085, unwished<wood>},
                                      {"marble", .07, unwished<marble>},
                                      {"stone", .035, unwished<stone>},
                                      {"grass", .035, unwished<grass>},
                                      {"snow", .025, unwished<snow>},
                                      {"ice", .02, unwished<ice>},
                                      {"leather", .025, unwished<leather>},
                                      {"rust", .03, unwished<rust>},
                                      {"striped", .105, stripes},
                                      {"checkered", .085, checks},
                                      {"dots", .075, dots},
                                      {"brick", .04, unwished<brick>},
                                      {"zebra", .025, unwished<zebra>},
                                      {"leopard", .025, unwished<leopard>},
                                      {"flames", .01, unwished<flames>}}};

}  // namespace
}  // namespace paint

const std::vector<std::string>& material_kinds() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const paint::Kind& kind : paint::kinds)
            all.emplace_back(kind.name);
        return all;
    }();
    return names;
}

ProceduralMaterial make_material(Random& random, const MaterialWish& wish) {
    double total = 0;
    for (const paint::Kind& kind : paint::kinds)
        total += kind.share;
    double at = random.uniform() * total;
    const paint::Kind* chosen = nullptr;
    for (const paint::Kind& kind : paint::kinds) {
        if (wish.kind.empty() ? (at -= kind.share) < 0 : wish.kind == kind.name) {
            chosen = &kind;
            break;
        }
    }
    if (!chosen && wish.kind.empty()) chosen = &paint::kinds[0];
    ITEM3D_CHECK(chosen, "no material is called " + wish.kind);
    return chosen->make(random, wish);
}

}  // namespace item3d
