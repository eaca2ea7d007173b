#include "item3d/prior/data/materials/plain.h"

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

    // "gray" and "grey" are the same word.
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

}  // namespace

std::vector<MaterialKind> plain_materials() {
    return {{"plain", .27, plain, {}}};
}

}  // namespace item3d::paint
