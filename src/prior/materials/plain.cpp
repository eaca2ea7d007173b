// One colour with a finish.
#include "item3d/prior/materials/makers.h"

#include <array>

namespace item3d::paint {
namespace {

ProceduralMaterial plain(Random& random, const MaterialWish& wish) {
    const std::string name = one_color(random, wish);
    const Vec3 color = vary(random, color_named(name), .09);
    struct Finish {
        const char* word;
        double share, low, high;
    };
    static constexpr std::array<Finish, 8> finishes{{{"", .5, .3, .7},
                                                     {"matte", .08, .8, 1},
                                                     {"glossy", .08, .08, .2},
                                                     {"ceramic", .1, .1, .25},
                                                     {"plastic", .1, .25, .4},
                                                     {"shiny", .06, .08, .2},
                                                     {"rubber", .04, .7, .9},
                                                     {"lacquered", .04, .06, .14}}};
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
        phrases = {c + " {o}",   c + " {o}", c + " {o}", "{o} painted " + c, "plain " + c + " {o}",
                   "{o} in " + c};
    } else if (word == "plastic" || word == "rubber") {
        phrases = {c + " " + word + " {o}", "{o} made of " + c + " " + word};
    } else if (word == "ceramic") {
        phrases = {c + " ceramic {o}", "ceramic " + c + " {o}"};
    }
    return {"", name, phrases, [=](const Vec3& p, const Vec3&) {
                const float shade = mottled > 0 ? 1 + mottled * noise(p) : 1.0f;
                return MaterialValue{limit(color * shade), roughness, 0};
            }};
}

/// Paint that has come off in places.
ProceduralMaterial chipped_paint(Random& random, const MaterialWish& wish) {
    const std::string name = one_color(random, wish);
    const Vec3 coat = vary(random, color_named(name));
    const bool on_wood = random.chance(.5);
    const Vec3 below = on_wood ? vary(random, {.42f, .25f, .12f}) : vary(random, {.3f, .28f, .26f});
    const CosineNoise chips(random, draw(random, 8, 12), 3);
    const float level = draw(random, .35, .75);
    return {"",
            name,
            {"chipped " + name + " {o}", "{o} with chipped " + name + " paint",
             "{o} with peeling " + name + " paint", "old painted " + name + " {o}"},
            [=](const Vec3& p, const Vec3&) {
                Vec3 gradient(0.0f);
                const float value = chips.with_gradient(p, gradient);
                const float bare = smooth_step(value, level, level + .2f);
                const bool edge = value > level - .15f && value < level + .25f;
                return MaterialValue{mix(coat, below, bare), .4f + .45f * bare,
                                     on_wood ? 0.0f : .7f * bare,
                                     edge ? gradient * -.03f : Vec3(0.0f)};
            }};
}

}  // namespace

std::vector<MaterialKind> plain_materials() {
    return {{"plain", .32, plain, {}},
            {"chipped paint",
             .015,
             chipped_paint,
             {word_of("materials", "chipped paint", "chipped", {"chipped", "peeling"},
                      "a {o} with chipped paint")}}};
}

}  // namespace item3d::paint
