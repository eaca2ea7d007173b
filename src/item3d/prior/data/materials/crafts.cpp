#include "item3d/prior/data/materials/crafts.h"

#include <array>

namespace item3d::paint {
namespace {

/// White ceramic with painted blue ornaments.
ProceduralMaterial porcelain(Random& random, const MaterialWish&) {
    const CosineNoise vines(random, draw(random, 5, 7), 1), fill(random, 9);
    const Vec3 body = vary(random, {.82f, .83f, .85f}, .03), ink = vary(random, {.02f, .06f, .4f});
    const float thin = draw(random, .16, .26);
    return {"",
            "",
            {"porcelain {o}", "porcelain {o}", "{o} made of porcelain",
             "blue and white porcelain {o}", "china {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float v = vines(p);
                const float line = 1 - smooth_step(std::abs(v), thin, thin + .15f);
                const float petal = smooth_step(v, 1.1f, 1.25f) * (.6f + .4f * std::tanh(fill(p)));
                return MaterialValue{mix(body, ink, std::clamp(line * .9f + petal * .7f, 0.f, 1.f)),
                                     .08f, 0};
            }};
}

/// Running glaze, which is dark where it is thick and has another tone at the rim.
ProceduralMaterial glaze(Random& random, const MaterialWish& wish) {
    const auto [first, second] = two_colors(random, wish);
    const Vec3 a = vary(random, color_named(first)), b = vary(random, color_named(second));
    const CosineNoise runs(random, 6, 2, {1, .25f, 1}), speckle(random, 24);
    const float level = draw(random, -.3, .35);
    return {"",
            first,
            {"glazed " + first + " {o}", "glazed " + first + " and " + second + " {o}",
             "{o} with a " + first + " glaze", "glazed {o}", "glazed pottery {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float w = smooth_step(p.y - level + .28f * runs(p), -.12f, .12f);
                const float spots = 1 - .35f * smooth_step(speckle(p), 1.1f, 1.6f);
                return MaterialValue{mix(b, a, w) * spots, .09f, 0};
            }};
}

/// Opaque imitation of glass, with dark clear tones, sharp highlights and bubbles.
ProceduralMaterial glass(Random& random, const MaterialWish& wish) {
    static constexpr std::array<const char*, 5> tones{"green", "blue", "", "brown", ""};
    const std::string tone =
        wish.color.empty() ? tones[static_cast<std::size_t>(random.index(5))] : wish.color;
    const Vec3 color = tone.empty() ? vary(random, {.5f, .6f, .62f}, .06)
                                    : vary(random, color_named(tone) * .55f + .02f);
    const CosineNoise depth(random, 2.2f, 2);
    const Wording words = wording(
        !tone.empty(), {tone + " glass {o}", "{o} made of " + tone + " glass"},
        {"glass {o}", "glass {o}", "{o} made of glass", "clear glass {o}", "shiny glass {o}"});
    return {"", tone, words.phrases,
            [=](const Vec3& p, const Vec3& n) {
                // Edges look darker, and the middle transmits light.
                const float through = smooth_step(depth(p) + .6f * n.y, -1.2f, 1.2f);
                return MaterialValue{limit(color * (.35f + 1.1f * through)), .04f, .55f};
            },
            words.also_true};
}

ProceduralMaterial leather(Random& random, const MaterialWish&) {
    static constexpr std::array<std::array<float, 3>, 3> hides{
        {{.2f, .08f, .03f}, {.03f, .02f, .018f}, {.3f, .05f, .03f}}};
    static constexpr std::array<const char*, 3> words{"brown", "black", "red"};
    const auto which = static_cast<std::size_t>(random.index(3));
    const auto& hide = hides[which];
    const Vec3 light = vary(random, {hide[0], hide[1], hide[2]});
    const std::string named = std::string(words[which]) + " leather {o}";
    return {"",
            "",
            {"leather {o}", "leather {o}", "{o} made of leather", named},
            grained(random, {.dark = light * .5f,
                             .light = light,
                             .frequency = 26,
                             .octaves = 1,
                             .rough_dark = .42f,
                             .rough_light = .65f,
                             .relief = .35f})};
}

/// Corrugated cardboard with brown ribs.
ProceduralMaterial cardboard(Random& random, const MaterialWish&) {
    const Vec3 tone = vary(random, {.5f, .33f, .18f}, .07);
    const float ribs = draw(random, 4, 5.5);
    return {"",
            "",
            {"cardboard {o}", "cardboard {o}", "{o} made of cardboard", "corrugated cardboard {o}"},
            [=](const Vec3& p, const Vec3& n) {
                const float phase = 2 * pi * flat_coordinates(p, n).x * ribs;
                return MaterialValue{tone * (1 + .14f * std::sin(phase)), .95f, 0,
                                     flat_slope({.45f * std::cos(phase), 0}, n)};
            }};
}

/// Polished green stone that looks slightly translucent.
ProceduralMaterial jade(Random& random, const MaterialWish&) {
    const CosineNoise clouds(random, 3.5f, 3);
    const Vec3 dark = vary(random, {.02f, .16f, .07f}), light = vary(random, {.25f, .55f, .32f});
    return {"",
            "",
            {"jade {o}", "jade {o}", "{o} made of jade", "{o} carved from jade"},
            [=](const Vec3& p, const Vec3&) {
                return MaterialValue{mix(dark, light, smooth_step(clouds(p), -1.4f, 1.4f)), .1f, 0};
            }};
}

}  // namespace

std::vector<MaterialKind> craft_materials() {
    return {{"porcelain",
             .02,
             porcelain,
             {material_word("porcelain", "porcelain", {"porcelain", "china"})}},
            {"glaze",
             .025,
             glaze,
             {colored(word_of("materials", "glaze", "glazed", {"glazed", "glaze"}),
                      "a glazed {c} and {d} {o}")}},
            {"glass", .03, glass, {material_word("glass", "glass")}},
            {"leather", .025, leather, {material_word("leather", "leather")}},
            {"cardboard", .015, cardboard, {material_word("cardboard", "cardboard")}},
            {"jade", .012, jade, {material_word("jade", "jade")}}};
}

}  // namespace item3d::paint
