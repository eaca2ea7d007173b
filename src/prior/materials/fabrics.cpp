// Fabrics, most of them dyed in a plain colour.
#include "item3d/prior/materials/makers.h"

namespace item3d::paint {
namespace {

std::vector<std::string> dyed(const std::string& color, const std::string& fabric) {
    return {color + " " + fabric + " {o}", color + " " + fabric + " {o}", fabric + " {o}",
            "{o} made of " + color + " " + fabric};
}

/// Felted tufts.
ProceduralMaterial wool(Random& random, const MaterialWish& wish) {
    const std::string name = one_color(random, wish);
    const Vec3 color = vary(random, color_named(name));
    std::vector<std::string> phrases = dyed(name, "wool");
    phrases.push_back("woolen {o}");
    return {"", name, phrases,
            grained(random, {.dark = color * .55f,
                             .light = limit(color * 1.15f + .01f),
                             .frequency = draw(random, 17, 24),
                             .octaves = 1,
                             .spread = 1,
                             .rough_dark = 1,
                             .rough_light = 1,
                             .relief = .8f})};
}

ProceduralMaterial denim(Random& random, const MaterialWish&) {
    const CosineNoise fade(random, 3.5f, 2);
    const Vec3 dark = vary(random, {.025f, .06f, .17f}), light = vary(random, {.16f, .27f, .45f});
    const float threads = draw(random, 34, 40);
    return {"",
            "",
            {"denim {o}", "denim {o}", "{o} made of denim", "blue denim {o}", "jeans {o}"},
            [=](const Vec3& p, const Vec3& n) {
                // Twill: diagonal ribs.
                const Vec2 uv = flat_coordinates(p, n);
                const float twill = std::sin((uv.x + uv.y) * threads);
                const float w = smooth_step(fade(p) + .55f * twill, -1.6f, 1.6f);
                return MaterialValue{mix(dark, light, w), .95f, 0};
            }};
}

/// Pile that lies one way or the other: patches of two shades, brightest at grazing light.
ProceduralMaterial velvet(Random& random, const MaterialWish& wish) {
    const std::string name = one_color(random, wish);
    const Vec3 color = vary(random, color_named(name), .07);
    const CosineNoise brushed(random, draw(random, 3.5, 5), 1);
    return {"", name, dyed(name, "velvet"), [=](const Vec3& p, const Vec3&) {
                Vec3 gradient(0.0f);
                const float lay = smooth_step(brushed.with_gradient(p, gradient), -.25f, .25f);
                return MaterialValue{limit(color * (.35f + .95f * lay)), 1, 0, gradient * .06f};
            }};
}

/// Rows of V-shaped stitches.
ProceduralMaterial knit(Random& random, const MaterialWish& wish) {
    const std::string name = one_color(random, wish);
    const Vec3 color = vary(random, color_named(name));
    const float columns = draw(random, 3.2, 4.4);
    return {"",
            name,
            {"knitted " + name + " {o}", "knitted " + name + " {o}", "knitted {o}", "knit {o}",
             "{o} knitted from " + name + " yarn"},
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

ProceduralMaterial silk(Random& random, const MaterialWish& wish) {
    const std::string name = one_color(random, wish);
    const Vec3 color = vary(random, color_named(name), .07);
    const CosineNoise folds(random, draw(random, 4, 6), 1, {1, .45f, 1});
    std::vector<std::string> phrases = dyed(name, "silk");
    phrases.push_back(name + " satin {o}");
    return {"", name, phrases, [=](const Vec3& p, const Vec3&) {
                Vec3 gradient(0.0f);
                folds.with_gradient(p, gradient);
                return MaterialValue{color, .24f, .35f, gradient * .12f};
            }};
}

/// Coarse plain weave.
ProceduralMaterial burlap(Random& random, const MaterialWish&) {
    const Vec3 tone = vary(random, {.5f, .34f, .16f}, .08);
    const float threads = draw(random, 3.4, 4.2);
    return {"",
            "",
            {"burlap {o}", "burlap {o}", "{o} made of burlap", "sackcloth {o}"},
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n) * threads;
                const float x = std::floor(uv.x), y = std::floor(uv.y);
                const bool over = odd(x + y);
                const float along = over ? uv.y - y : uv.x - x, across = over ? uv.x - x : uv.y - y;
                const float thread = std::sin(pi * across) * (.6f + .4f * std::sin(pi * along));
                const float slope = -.6f * std::cos(pi * across);
                return MaterialValue{tone * (.3f + .8f * thread + .25f * cell_value(x, y)), 1, 0,
                                     flat_slope(over ? Vec2(slope, 0) : Vec2(0, slope), n)};
            }};
}

}  // namespace

std::vector<MaterialKind> fabric_materials() {
    return {{"wool", .02, wool, {material_word("wool", "wool", {"wool", "woolen"})}},
            {"denim", .02, denim, {material_word("denim", "denim", {"denim", "jeans"})}},
            {"velvet", .02, velvet, {material_word("velvet", "velvet")}},
            {"knit", .025, knit, {material_word("knit", "knitted", {"knitted", "knit", "yarn"})}},
            {"silk", .015, silk, {material_word("silk", "silk", {"silk", "satin"})}},
            {"burlap", .015, burlap, {material_word("burlap", "burlap", {"burlap", "sackcloth"})}}};
}

}  // namespace item3d::paint
