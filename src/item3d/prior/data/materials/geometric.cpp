#include "item3d/prior/data/materials/geometric.h"

namespace item3d::paint {
namespace {

struct TwoTone {
    std::string first, second;  ///< names
    Vec3 a, b;
    float roughness;
    bool named;  ///< true if captions name the colours
};

/// Fraction of images whose captions omit the colours. The pattern then has its typical colours.
constexpr double usual_share = .35;

TwoTone two_tones(Random& random, const MaterialWish& wish, const std::string& usual_first,
                  const std::string& usual_second) {
    const bool named = !wish.color.empty() || !random.chance(usual_share);
    const auto [first, second] =
        named ? two_colors(random, wish) : std::pair(usual_first, usual_second);
    const Vec3 a = vary(random, color_named(first), .09),
               b = vary(random, color_named(second), .09);
    return {first, second, a, b, draw(random, .3, .8), named};
}

/// Returns "red and white striped {o}" and other orders of the same words, or "striped {o}".
Wording wording_of(const TwoTone& tones, const std::string& adjective, const std::string& noun) {
    const std::string both = tones.first + " and " + tones.second;
    return wording(tones.named,
                   {both + " " + adjective + " {o}", both + " " + adjective + " {o}",
                    adjective + " " + both + " {o}", "{o} with " + both + " " + noun,
                    "{o} with " + noun + " in " + both},
                   {adjective + " {o}", adjective + " {o}", "{o} with " + noun});
}

// All of these patterns have a fixed place in the coordinates of the object. The network knows the
// position (shape_condition.h). A network as small as ours would draw blots if the place of each
// stripe were random.

ProceduralMaterial stripes(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish, "red", "white");
    const Wording words = wording_of(tones, "striped", "stripes");
    return {"", tones.first, words.phrases,
            [=](const Vec3& p, const Vec3&) {
                const float s = fraction(p.y * cells_a_unit);
                const float w = smooth_step(std::abs(s - .5f), .235f, .265f);
                return MaterialValue{mix(tones.a, tones.b, w), tones.roughness, 0};
            },
            words.also_true};
}

ProceduralMaterial checks(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish, "black", "white");
    Wording words = wording_of(tones, "checkered", "checks");
    if (!tones.named) words.phrases.emplace_back("{o} with a checkerboard pattern");
    return {"", tones.first, words.phrases,
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n) * cells_a_unit;
                const float sum = std::floor(uv.x) + std::floor(uv.y);
                return MaterialValue{odd(sum) ? tones.b : tones.a, tones.roughness, 0};
            },
            words.also_true};
}

ProceduralMaterial dots(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish, "red", "white");
    const auto& [first, second, a, b, roughness, named] = tones;
    constexpr float size = .3f;
    const std::string both = first + " and " + second;
    const Wording words = wording(
        named,
        {both + " polka dot {o}", both + " polka dot {o}",
         first + " {o} with " + second + " polka dots", first + " {o} with " + second + " dots"},
        {"polka dot {o}", "polka dot {o}", "{o} with polka dots", "dotted {o}", "{o} with dots"});
    return {"", first, words.phrases,
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n) * cells_a_unit;
                const float row = std::floor(uv.y);
                const float u = uv.x + (odd(row) ? .5f : 0.0f);
                const float d = std::hypot(fraction(u) - .5f, uv.y - row - .5f);
                const float w = smooth_step(d, size - .02f, size + .03f);
                return MaterialValue{mix(tones.b, tones.a, w), tones.roughness, 0};
            },
            words.also_true};
}

ProceduralMaterial zigzags(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish, "orange", "white");
    Wording words = wording_of(tones, "zigzag", "zigzags");
    if (!tones.named) words.phrases.emplace_back("{o} with a chevron pattern");
    return {"", tones.first, words.phrases,
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n) * cells_a_unit;
                // A tooth is as wide as two checks. The pattern then has fewer corners that a small
                // network could round off.
                const float tooth = 2 * std::abs(fraction(uv.x * .5f) - .5f);
                const float s = fraction(uv.y + tooth);
                const float w = smooth_step(std::abs(s - .5f), .23f, .27f);
                return MaterialValue{mix(tones.a, tones.b, w), tones.roughness, 0};
            },
            words.also_true};
}

/// Woven bands, with a third tone where they cross, and a thin line.
ProceduralMaterial tartan(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish, "red", "green");
    const Vec3 line = color_named("yellow");
    Wording words = wording_of(tones, "tartan", "tartan");
    words.phrases.push_back(tones.named ? "plaid " + tones.first + " and " + tones.second + " {o}"
                                        : "plaid {o}");
    return {"", tones.first, words.phrases,
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n);
                const float x = fraction(uv.x), y = fraction(uv.y);
                const float bands = (x < .5f ? .5f : 0.0f) + (y < .5f ? .5f : 0.0f);
                const bool thin = std::abs(x - .25f) < .09f || std::abs(y - .25f) < .09f;
                const Vec3 cloth = mix(tones.a, tones.b, bands);
                return MaterialValue{thin ? mix(cloth, line, .85f) : cloth, .95f, 0};
            },
            words.also_true};
}

/// Gradient from one colour below to another above.
ProceduralMaterial gradient(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish, "pink", "blue");
    Vec3 up(random.normal(0, .25), 1, random.normal(0, .25));
    up = glm::normalize(up);
    const float middle = draw(random, -.2, .2), half = draw(random, .45, .7);
    const std::string to = tones.first + " to " + tones.second;
    const Wording words = wording(tones.named,
                                  {tones.first + " and " + tones.second + " gradient {o}",
                                   "{o} with a " + to + " gradient", "{o} fading from " + to},
                                  {"gradient {o}", "{o} with a gradient"});
    return {"", tones.first, words.phrases,
            [=](const Vec3& p, const Vec3&) {
                // The gradient goes from the first colour at the top to the second at the bottom.
                const float w = smooth_step(glm::dot(p, up), middle - half, middle + half);
                return MaterialValue{mix(tones.b, tones.a, w), tones.roughness, 0};
            },
            words.also_true};
}

}  // namespace

std::vector<MaterialKind> geometric_patterns() {
    return {
        {"striped",
         .1,
         stripes,
         {colored(pattern_word("striped", "striped", {"striped", "stripes"}),
                  "a {c} and {d} striped {o}")}},
        {"checkered",
         .1,
         checks,
         {colored(pattern_word("checkered", "checkered", {"checkered", "checkerboard", "checks"}),
                  "a {c} and {d} checkered {o}")}},
        {"dots",
         .1,
         dots,
         {colored(pattern_word("dots", "polka dot", {"polka", "dot", "dots", "dotted"}),
                  "a {c} and {d} polka dot {o}")}},
        {"zigzag",
         .08,
         zigzags,
         {colored(pattern_word("zigzag", "zigzag", {"zigzag", "zigzags", "chevron"}),
                  "a {c} and {d} zigzag {o}")}},
        {"tartan",
         .08,
         tartan,
         {colored(pattern_word("tartan", "tartan", {"tartan", "plaid"}),
                  "a {c} and {d} tartan {o}")}},
        {"gradient",
         .04,
         gradient,
         {colored(pattern_word("gradient", "gradient", {"gradient", "fading"}),
                  "a {c} and {d} gradient {o}")}}};
}

}  // namespace item3d::paint
