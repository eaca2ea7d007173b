#include "item3d/prior/data/materials/metals.h"

#include <array>

namespace item3d::paint {
namespace {

enum class MetalFinish { smooth, polished, brushed, hammered, tarnished };

std::string adjective_of(const std::string& metal) {
    return metal == "gold" ? "golden" : metal;
}

std::vector<std::string> metal_phrases(const std::string& name, MetalFinish finish) {
    const std::string word = adjective_of(name);
    switch (finish) {
        case MetalFinish::polished:
            return {"polished " + name + " {o}", "{o} made of polished " + name,
                    "shiny " + word + " {o}"};
        case MetalFinish::brushed:
            return {"brushed " + name + " {o}", "{o} made of brushed " + name};
        case MetalFinish::hammered:
            return {"hammered " + name + " {o}", "{o} made of hammered " + name};
        case MetalFinish::tarnished:
            return {"tarnished " + name + " {o}", "old " + word + " {o}"};
        case MetalFinish::smooth:
            break;
    }
    std::vector<std::string> phrases{word + " {o}", word + " {o}", name + " {o}",
                                     "{o} made of " + name, "shiny " + word + " {o}"};
    if (name == "silver" || name == "steel") phrases.push_back("metal {o}");
    if (name == "chrome") phrases.push_back("chrome plated {o}");
    return phrases;
}

MetalFinish draw_finish(Random& random) {
    const double at = random.uniform();
    return at < .6    ? MetalFinish::smooth
           : at < .72 ? MetalFinish::polished
           : at < .82 ? MetalFinish::brushed
           : at < .92 ? MetalFinish::hammered
                      : MetalFinish::tarnished;
}

ProceduralMaterial metal(Random& random, const MaterialWish& wish) {
    static constexpr std::array<double, 8> shares{.22, .16, .14, .1, .1, .09, .09, .1};
    const auto& metals = metal_colors();
    std::string name = metals.back().name;
    double at = random.uniform();
    for (std::size_t i = 0; i < shares.size(); ++i) {
        name = metals[i].name;
        if ((at -= shares[i]) < 0) break;
    }
    if (!wish.color.empty()) name = wish.color;
    const MetalFinish finish = wish.color.empty() ? draw_finish(random) : MetalFinish::smooth;
    const bool mirror = finish == MetalFinish::polished || name == "chrome";
    const Vec3 color = vary(random, color_named(name), .05);
    const auto [smoothest, roughest] = metal_roughness_range(mirror ? "chrome" : name);
    const float roughness = finish == MetalFinish::brushed && !mirror
                                ? draw(random, .35, .5)
                                : draw(random, smoothest, roughest);
    const CosineNoise stains(random, 4, 3);
    const CosineNoise scratches(random, 26, 1, Vec3(.12f, 1, .12f));
    const float dents = draw(random, 4.5, 6.5);
    const Vec3 stain = name == "copper" || name == "bronze" || name == "brass"
                           ? Vec3(.12f, .3f, .22f)
                           : color * .25f;
    return {"", name, metal_phrases(name, finish),
            [=](const Vec3& p, const Vec3&) {
                MaterialValue value{color, roughness, 1};
                if (finish == MetalFinish::brushed) {
                    const float line = scratches.with_gradient(p, value.slope);
                    value.slope *= .006f;
                    value.base_color = limit(color * (1 + .07f * line));
                } else if (finish == MetalFinish::hammered) {
                    // The relief has shallow bowls around the cells' points.
                    const float step = .02f;
                    const auto height = [&](const Vec3& q) {
                        const float d = near_points(q * dents).first;
                        return d * d;
                    };
                    const float here = height(p);
                    for (int c = 0; c < 3; ++c) {
                        Vec3 q = p;
                        q[c] += step;
                        value.slope[c] = (height(q) - here) / step * .09f;
                    }
                } else if (finish == MetalFinish::tarnished) {
                    const float w = smooth_step(stains(p), -.3f, 1.2f);
                    value = {mix(color * .7f, stain, w), .35f + .4f * w, 1 - .7f * w};
                }
                return value;
            },
            // A polished golden mug may also be called golden.
            finish == MetalFinish::smooth ? std::vector<std::string>{}
                                          : std::vector<std::string>{adjective_of(name) + " {o}"}};
}

ProceduralMaterial rust(Random& random, const MaterialWish&) {
    const CosineNoise patches(random, draw(random, 4, 8), 3), grain(random, 20);
    const Vec3 iron = vary(random, {.25f, .22f, .2f});
    const Vec3 light = vary(random, {.35f, .1f, .02f}), dark = vary(random, {.12f, .04f, .02f});
    return {"",
            "",
            {"rusty {o}", "rusty metal {o}", "{o} made of rusty iron", "rusty iron {o}",
             "{o} covered in rust"},
            [=](const Vec3& p, const Vec3&) {
                const float w = smooth_step(patches(p), -.6f, .6f);
                Vec3 gradient(0.0f);
                const float flakes = smooth_step(grain.with_gradient(p, gradient), -1, 1);
                return MaterialValue{mix(iron, mix(light, dark, flakes), w), .45f + .45f * w, 1 - w,
                                     gradient * (.012f * w)};
            }};
}

}  // namespace

std::vector<MaterialKind> metal_materials() {
    std::vector<MaterialWord> words;
    for (const PlainColor& each : metal_colors()) {
        MaterialWord word = material_word("metal", each.name);
        word.wish.color = each.name;
        if (each.name == "gold") {
            word.spellings = {"gold", "golden"};
            word.caption = "a golden {o}";
        }
        if (each.name == "silver") word.spellings = {"silver", "metal"};
        words.push_back(word);
    }
    return {{"metal", .16, metal, words},
            {"rust",
             .025,
             rust,
             {word_of("materials", "rust", "rust", {"rusty", "rust"}, "a rusty {o}")}}};
}

}  // namespace item3d::paint
