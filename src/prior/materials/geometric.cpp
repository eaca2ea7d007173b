// Patterns of two colours: what the prior finds hardest, so cells are large and edges soft enough
// to survive 64 pixels.
#include "item3d/prior/materials/makers.h"

namespace item3d::paint {
namespace {

struct TwoTone {
    std::string first, second;  ///< names
    Vec3 a, b;
    float roughness;
};

TwoTone two_tones(Random& random, const MaterialWish& wish) {
    const auto [first, second] = two_colors(random, wish);
    const Vec3 a = vary(random, color_named(first), .09),
               b = vary(random, color_named(second), .09);
    return {first, second, a, b, draw(random, .3, .8)};
}

Vec3 any_shift(Random& random) {
    return {draw(random, 0, 1), draw(random, 0, 1), draw(random, 0, 1)};
}

/// "red and white striped {o}" and other orders of the same words.
std::vector<std::string> ways_to_say(const TwoTone& tones, const std::string& adjective,
                                     const std::string& noun) {
    const std::string both = tones.first + " and " + tones.second;
    return {both + " " + adjective + " {o}",
            both + " " + adjective + " {o}",
            adjective + " " + both + " {o}",
            adjective + " {o}",
            adjective + " {o}",
            "{o} with " + both + " " + noun,
            "{o} with " + noun,
            "{o} with " + noun + " in " + both};
}

ProceduralMaterial stripes(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish);
    Vec3 axis(0.0f);
    axis[random.chance(.6) ? 1 : random.chance(.5) ? 0 : 2] = 1.0f;
    if (random.chance(.25)) {
        axis += Vec3{random.normal(0, .5), random.normal(0, .5), random.normal(0, .5)};
    }
    axis = glm::normalize(axis);
    const float frequency = draw(random, 1.6, 3.3), shift = draw(random, 0, 1);
    return {"", tones.first, ways_to_say(tones, "striped", "stripes"),
            [=](const Vec3& p, const Vec3&) {
                const float s = fraction(glm::dot(p, axis) * frequency + shift);
                const float w = smooth_step(std::abs(s - .5f), .235f, .265f);
                return MaterialValue{mix(tones.a, tones.b, w), tones.roughness, 0};
            }};
}

ProceduralMaterial checks(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish);
    const float frequency = draw(random, 1.5, 2.9);
    const Vec3 shift = any_shift(random);
    const bool flat = random.chance(.6);
    std::vector<std::string> phrases = ways_to_say(tones, "checkered", "checks");
    phrases.push_back("{o} with a checkerboard pattern");
    return {"", tones.first, phrases, [=](const Vec3& p, const Vec3& n) {
                const Vec3 q = p * frequency + shift;
                const Vec2 uv = flat_coordinates(q, n);
                const float sum = flat ? std::floor(uv.x) + std::floor(uv.y)
                                       : std::floor(q.x) + std::floor(q.y) + std::floor(q.z);
                return MaterialValue{odd(sum) ? tones.b : tones.a, tones.roughness, 0};
            }};
}

ProceduralMaterial dots(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish);
    const auto& [first, second, a, b, roughness] = tones;
    const float frequency = draw(random, 1.7, 2.9), size = draw(random, .24, .33);
    const Vec3 shift = any_shift(random);
    return {
        "",
        first,
        {first + " and " + second + " polka dot {o}", first + " {o} with " + second + " polka dots",
         first + " {o} with " + second + " dots", "polka dot {o}", "polka dot {o}",
         "{o} with polka dots", "{o} with " + second + " dots", "dotted {o}"},
        [=](const Vec3& p, const Vec3& n) {
            const Vec2 uv = flat_coordinates(p * frequency + shift, n);
            const float row = std::floor(uv.y);
            const float u = uv.x + (odd(row) ? .5f : 0.0f);
            const float d = std::hypot(fraction(u) - .5f, uv.y - row - .5f);
            const float w = smooth_step(d, size - .02f, size + .03f);
            return MaterialValue{mix(tones.b, tones.a, w), tones.roughness, 0};
        }};
}

ProceduralMaterial zigzags(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish);
    const float frequency = draw(random, 1.5, 2.4), width = draw(random, 1.3, 2.2);
    std::vector<std::string> phrases = ways_to_say(tones, "zigzag", "zigzags");
    phrases.push_back("{o} with a chevron pattern");
    return {"", tones.first, phrases, [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n);
                const float tooth = std::abs(fraction(uv.x * width) - .5f) * 2 / width;
                const float s = fraction((uv.y + tooth * .8f) * frequency);
                const float w = smooth_step(std::abs(s - .5f), .23f, .27f);
                return MaterialValue{mix(tones.a, tones.b, w), tones.roughness, 0};
            }};
}

/// Crossing bands, as woven: a third tone where they cross, and a thin line.
ProceduralMaterial tartan(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish);
    const float frequency = draw(random, 1.3, 2), wide = draw(random, .38, .55);
    const Vec3 line = color_named(random.chance(.5) ? "white" : "yellow"),
               shift = any_shift(random);
    std::vector<std::string> phrases = ways_to_say(tones, "tartan", "tartan");
    phrases[5] = "{o} in " + tones.first + " and " + tones.second + " tartan";
    phrases[6] = "plaid {o}";
    phrases[7] = "{o} with a tartan pattern";
    return {"", tones.first, phrases, [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p * frequency + shift, n);
                const float x = fraction(uv.x), y = fraction(uv.y);
                const float bands = (x < wide ? .5f : 0.0f) + (y < wide ? .5f : 0.0f);
                const bool thin =
                    std::abs(x - wide * .5f) < .05f || std::abs(y - wide * .5f) < .05f;
                const Vec3 cloth = mix(tones.a, tones.b, bands);
                return MaterialValue{thin ? mix(cloth, line, .7f) : cloth, .95f, 0};
            }};
}

/// From one colour below to another above.
ProceduralMaterial gradient(Random& random, const MaterialWish& wish) {
    const TwoTone tones = two_tones(random, wish);
    Vec3 up(random.normal(0, .25), 1, random.normal(0, .25));
    up = glm::normalize(up);
    const float middle = draw(random, -.2, .2), half = draw(random, .45, .7);
    const std::string to = tones.first + " to " + tones.second;
    return {"",
            tones.first,
            {"gradient {o}", tones.first + " and " + tones.second + " gradient {o}",
             "{o} with a " + to + " gradient", "{o} fading from " + to},
            [=](const Vec3& p, const Vec3&) {
                // From the first colour at the top down to the second.
                const float w = smooth_step(glm::dot(p, up), middle - half, middle + half);
                return MaterialValue{mix(tones.b, tones.a, w), tones.roughness, 0};
            }};
}

}  // namespace

std::vector<MaterialKind> geometric_patterns() {
    return {
        {"striped",
         .09,
         stripes,
         {colored(pattern_word("striped", "striped", {"striped", "stripes"}),
                  "a {c} and {d} striped {o}")}},
        {"checkered",
         .07,
         checks,
         {colored(pattern_word("checkered", "checkered", {"checkered", "checkerboard", "checks"}),
                  "a {c} and {d} checkered {o}")}},
        {"dots",
         .07,
         dots,
         {colored(pattern_word("dots", "polka dot", {"polka", "dot", "dots", "dotted"}),
                  "a {c} and {d} polka dot {o}")}},
        {"zigzag",
         .05,
         zigzags,
         {colored(pattern_word("zigzag", "zigzag", {"zigzag", "zigzags", "chevron"}),
                  "a {c} and {d} zigzag {o}")}},
        {"tartan",
         .055,
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
