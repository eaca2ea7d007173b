#include "item3d/prior/data/materials/foods.h"

#include <array>

namespace item3d::paint {
namespace {

ProceduralMaterial chocolate(Random& random, const MaterialWish&) {
    const bool dark = random.chance(.5);
    const Vec3 tone =
        dark ? vary(random, {.06f, .022f, .01f}, .08) : vary(random, {.17f, .07f, .03f}, .08);
    const CosineNoise drips(random, 5, 1);
    std::vector<std::string> phrases{"chocolate {o}", "chocolate {o}", "{o} made of chocolate"};
    phrases.push_back(dark ? "dark chocolate {o}" : "milk chocolate {o}");
    return {"", "", phrases, [=](const Vec3& p, const Vec3&) {
                Vec3 gradient(0.0f);
                const float w = drips.with_gradient(p, gradient);
                return MaterialValue{limit(tone * (1 + .12f * w)), .22f, 0, gradient * .05f};
            }};
}

/// Yellow cheese with round holes.
ProceduralMaterial cheese(Random& random, const MaterialWish&) {
    const Vec3 tone = vary(random, {.88f, .58f, .1f}, .07);
    const float size = draw(random, 1.7, 2.3);
    return {
        "",
        "",
        {"cheese {o}", "cheese {o}", "{o} made of cheese", "swiss cheese {o}"},
        [=](const Vec3& p, const Vec3&) {
            const NearPoints near = near_points(p * size);
            const float radius = .2f + .24f * near.value;
            const float hole = 1 - smooth_step(near.first, radius - .04f, radius + .02f);
            return MaterialValue{tone * (1 - hole * (.45f + .35f * near.first / radius)), .4f, 0};
        }};
}

/// Glossy red and white swirls.
ProceduralMaterial candy(Random& random, const MaterialWish&) {
    const Vec3 stripe =
        vary(random, random.chance(.6) ? Vec3(.7f, .015f, .03f) : Vec3(.85f, .2f, .42f), .06);
    const float twist = draw(random, 3, 6) * (random.chance(.5) ? 1.0f : -1.0f);
    const auto bands = static_cast<float>(2 + random.index(3));
    return {"",
            "",
            {"candy {o}", "candy cane {o}", "{o} made of candy", "peppermint candy {o}"},
            [=](const Vec3& p, const Vec3&) {
                const float phase = std::atan2(p.z, p.x) * bands + p.y * twist * 1.6f;
                const float w = smooth_step(std::sin(phase), -.2f, .2f);
                return MaterialValue{mix({.86f, .84f, .82f}, stripe, w), .1f, 0};
            }};
}

/// Sticks of icing sugar in four orientations.
ProceduralMaterial sprinkles(Random& random, const MaterialWish&) {
    static constexpr std::array<std::array<float, 3>, 5> tones{{{.8f, .05f, .05f},
                                                                {.05f, .3f, .8f},
                                                                {.95f, .75f, .05f},
                                                                {.1f, .6f, .15f},
                                                                {.85f, .85f, .85f}}};
    const bool pink = random.chance(.75);
    const Vec3 base =
        pink ? vary(random, {.86f, .36f, .48f}, .07) : vary(random, {.12f, .045f, .02f}, .07);
    return {"",
            "",
            {"sprinkle covered {o}", "{o} covered in sprinkles", "{o} with sprinkles"},
            [=](const Vec3& p, const Vec3& n) {
                const Vec2 uv = flat_coordinates(p, n) * cells_a_unit;
                const Vec2 cell = glm::floor(uv), q = uv - cell - .5f;
                const auto number = [&](int which) { return cell_value(cell.x, cell.y, which); };
                const float angle = std::floor(number(0) * 4) * pi / 4;
                const Vec2 along(std::cos(angle), std::sin(angle));
                const float beyond = std::max(std::abs(glm::dot(q, along)) - .2f, 0.0f);
                const float aside = q.x * along.y - q.y * along.x;
                const bool on = std::hypot(beyond, aside) < .17f;
                const auto& tone = tones[static_cast<std::size_t>(number(1) * 4.999f)];
                return MaterialValue{on ? Vec3(tone[0], tone[1], tone[2]) : base, .3f, 0};
            }};
}

}  // namespace

std::vector<MaterialKind> food_materials() {
    return {
        {"chocolate", .02, chocolate, {material_word("chocolate", "chocolate")}},
        {"cheese", .015, cheese, {material_word("cheese", "cheese")}},
        {"candy", .015, candy, {material_word("candy", "candy", {"candy", "cane", "peppermint"})}},
        {"sprinkles",
         .025,
         sprinkles,
         {word_of("patterns", "sprinkles", "sprinkles", {"sprinkles", "sprinkle"},
                  "a {o} covered in sprinkles")}}};
}

}  // namespace item3d::paint
