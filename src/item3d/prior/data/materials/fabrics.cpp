#include "item3d/prior/data/materials/fabrics.h"

namespace item3d::paint {
namespace {

/// Dye of a fabric: a colour that captions name, or the fabric's typical colour.
struct Dye {
    std::string color;
    Wording words;
};

Dye dye(Random& random, const MaterialWish& wish, const std::string& fabric,
        const std::string& usual) {
    const bool named = !wish.color.empty() || random.chance(.65);
    const std::string color = named ? one_color(random, wish) : usual, both = color + " " + fabric;
    return {color, wording(named, {both + " {o}", both + " {o}", "{o} made of " + both},
                           {fabric + " {o}", fabric + " {o}", "{o} made of " + fabric})};
}

ProceduralMaterial denim(Random& random, const MaterialWish&) {
    const CosineNoise fade(random, 3.5f, 2);
    const Vec3 dark = vary(random, {.025f, .06f, .17f}), light = vary(random, {.16f, .27f, .45f});
    const float threads = draw(random, 34, 40);
    return {"",
            "",
            {"denim {o}", "denim {o}", "{o} made of denim", "blue denim {o}", "jeans {o}"},
            [=](const Vec3& p, const Vec3& n) {
                // Twill has diagonal ribs.
                const Vec2 uv = flat_coordinates(p, n);
                const float twill = std::sin((uv.x + uv.y) * threads);
                const float w = smooth_step(fade(p) + .55f * twill, -1.6f, 1.6f);
                return MaterialValue{mix(dark, light, w), .95f, 0};
            }};
}

/// Pile that lies in two directions, and so forms patches of two shades.
ProceduralMaterial velvet(Random& random, const MaterialWish& wish) {
    const auto [name, words] = dye(random, wish, "velvet", "maroon");
    const Vec3 color = vary(random, color_named(name), .07);
    const CosineNoise brushed(random, draw(random, 3.5, 5), 1);
    return {"", name, words.phrases,
            [=](const Vec3& p, const Vec3&) {
                Vec3 gradient(0.0f);
                const float lay = smooth_step(brushed.with_gradient(p, gradient), -.25f, .25f);
                return MaterialValue{limit(color * (.35f + .95f * lay)), 1, 0, gradient * .06f};
            },
            words.also_true};
}

/// Rows of V-shaped stitches.
ProceduralMaterial knit(Random& random, const MaterialWish& wish) {
    const std::string name = one_color(random, wish);
    const Vec3 color = vary(random, color_named(name));
    const float columns = draw(random, 2.6, 3.4);
    return {"",
            name,
            {"knitted " + name + " {o}", "knitted " + name + " {o}", "knitted {o}", "knit {o}",
             "{o} knitted from " + name + " yarn", "{o} knitted from " + name + " wool"},
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n);
                const float across = fraction(uv.x * columns) * 2 - 1;  // one V
                const float lean = std::abs(across);
                const float up = fraction(uv.y * columns * 1.25f - lean * .7f);
                const float yarn = std::sin(pi * up) * std::sin(pi * std::min(lean * 1.0f, 1.0f));
                const float shade = .3f + .85f * smooth_step(yarn, 0, .6f);
                const Vec2 slope((across < 0 ? -1.0f : 1.0f) * .4f * std::cos(pi * lean),
                                 -.5f * std::cos(pi * up));
                return MaterialValue{limit(color * shade), 1, 0, flat_slope(slope, n)};
            }};
}

/// Shiny hanging folds.
ProceduralMaterial silk(Random& random, const MaterialWish& wish) {
    auto [name, words] = dye(random, wish, "silk", "pink");
    const Vec3 color = vary(random, color_named(name), .07);
    Random drape(3);
    const CosineNoise folds(drape, 7, 1, {1, .25f, 1});
    words.phrases.emplace_back("satin {o}");
    return {
        "", name, words.phrases,
        [=](const Vec3& p, const Vec3&) {
            Vec3 gradient(0.0f);
            const float height = smooth_step(folds.with_gradient(p, gradient), -.9f, .9f);
            return MaterialValue{limit(color * (.4f + .75f * height)), .24f, .35f, gradient * .14f};
        },
        words.also_true};
}

}  // namespace

std::vector<MaterialKind> fabric_materials() {
    return {
        {"denim", .02, denim, {material_word("denim", "denim", {"denim", "jeans"})}},
        {"velvet", .03, velvet, {colored(material_word("velvet", "velvet"), "a {c} velvet {o}")}},
        {"knit",
         .03,
         knit,
         {colored(material_word("knit", "knitted", {"knitted", "knit", "yarn", "wool"}),
                  "a knitted {c} {o}")}},
        {"silk",
         .03,
         silk,
         {colored(material_word("silk", "silk", {"silk", "satin"}), "a {c} silk {o}")}}};
}

}  // namespace item3d::paint
