#include "item3d/core/error.h"
#include "item3d/prior/data/materials/makers.h"

namespace item3d {

const std::vector<PlainColor>& plain_colors() {
    static const std::vector<PlainColor> colors{
        {"red", {.7f, .02f, .02f}},        {"green", {.03f, .42f, .05f}},
        {"blue", {.02f, .08f, .65f}},      {"yellow", {.85f, .65f, .02f}},
        {"orange", {.85f, .25f, .01f}},    {"purple", {.28f, .03f, .5f}},
        {"pink", {.85f, .3f, .45f}},       {"white", {.85f, .85f, .85f}},
        {"black", {.012f, .012f, .012f}},  {"gray", {.22f, .22f, .22f}},
        {"brown", {.16f, .06f, .02f}},     {"cyan", {.02f, .6f, .65f}},
        {"navy", {.008f, .012f, .1f}},     {"teal", {.0f, .16f, .17f}},
        {"maroon", {.15f, .005f, .015f}},  {"olive", {.16f, .16f, .01f}},
        {"lime", {.42f, .8f, .02f}},       {"magenta", {.75f, .01f, .45f}},
        {"lavender", {.5f, .4f, .8f}},     {"beige", {.72f, .6f, .42f}},
        {"turquoise", {.04f, .58f, .42f}}, {"salmon", {.88f, .3f, .2f}},
        {"mint", {.45f, .85f, .58f}},      {"mustard", {.5f, .28f, .015f}}};
    return colors;
}

const std::vector<PlainColor>& metal_colors() {
    static const std::vector<PlainColor> colors{
        {"gold", {1.f, .63f, .18f}},    {"silver", {.92f, .91f, .88f}},
        {"copper", {.92f, .42f, .26f}}, {"bronze", {.5f, .3f, .11f}},
        {"brass", {.82f, .62f, .22f}},  {"steel", {.56f, .57f, .58f}},
        {"iron", {.22f, .21f, .2f}},    {"chrome", {.72f, .74f, .76f}}};
    return colors;
}

namespace paint {
namespace {

std::uint64_t cell_bits(float x, float y, float z) {
    const auto part = [](float v) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(v) + 4096);
    };
    return mix_bits(part(x) * 73856093u ^ part(y) * 19349663u << 13 ^ part(z) * 83492791u << 26);
}

}  // namespace

MaterialWord word_of(const std::string& group, const std::string& kind, const std::string& word,
                     const std::vector<std::string>& spellings, const std::string& caption) {
    return {group,
            word,
            caption.empty() ? "a " + word + " {o}" : caption,
            spellings.empty() ? std::vector<std::string>{word} : spellings,
            {kind, "", ""},
            ""};
}

Vec3 vary(Random& random, const Vec3& color, double spread) {
    const double all = random.normal(0, spread);
    Vec3 result;
    for (int c = 0; c < 3; ++c) {
        result[c] = color[c] * static_cast<float>(std::exp(random.normal(0, spread) * .6 + all));
    }
    return limit(result);
}

Vec3 color_named(const std::string& name) {
    for (const auto* colors : {&plain_colors(), &metal_colors()})
        for (const PlainColor& color : *colors)
            if (color.name == name) return color.linear;
    ITEM3D_CHECK(false, "no colour is called " + name);
    return {};
}

std::string one_color(Random& random, const MaterialWish& wish) {
    const auto& colors = plain_colors();
    const auto any = random.index(static_cast<std::int64_t>(colors.size()));
    return wish.color.empty() ? colors[static_cast<std::size_t>(any)].name : wish.color;
}

std::pair<std::string, std::string> two_colors(Random& random, const MaterialWish& wish) {
    // White is every pattern's favourite partner; it also keeps the two apart.
    std::string first = one_color(random, wish);
    std::string second = random.chance(.3) ? "white" : one_color(random, {});
    if (!wish.second_color.empty()) second = wish.second_color;
    while (second == first || (wish.second_color.empty() && colors_alike(first, second)))
        second = one_color(random, {});
    return {first, second};
}

float cell_value(float x, float y, float z) {
    return static_cast<float>(cell_bits(x, y, z) >> 40) * 0x1.0p-24f;
}

NearPoints near_points(const Vec3& p) {
    const Vec3 base = glm::floor(p);
    NearPoints near{9, 9, 0};
    for (int i = 0; i < 27; ++i) {
        const Vec3 cell = base + Vec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        const std::uint64_t bits = cell_bits(cell.x, cell.y, cell.z);
        const Vec3 offset(static_cast<float>(bits & 0xffffu),
                          static_cast<float>(bits >> 16 & 0xffffu),
                          static_cast<float>(bits >> 32 & 0xffffu));
        const float distance = glm::length(cell + .15f + .7f / 65536.0f * offset - p);
        if (distance < near.first) {
            near.second = near.first;
            near.first = distance;
            near.value = static_cast<float>(bits >> 40) * 0x1.0p-24f;
        } else if (distance < near.second) {
            near.second = distance;
        }
    }
    return near;
}

std::function<MaterialValue(const Vec3&, const Vec3&)> grained(Random& random, const Grain& grain) {
    const CosineNoise noise(random, grain.frequency, grain.octaves, grain.stretch);
    // The noise's gradient is about its frequency; a height of so much gives the slope asked for.
    const float height = grain.relief / grain.frequency;
    return [=](const Vec3& p, const Vec3&) {
        Vec3 gradient(0.0f);
        const float value = height > 0 ? noise.with_gradient(p, gradient) : noise(p);
        const float w = smooth_step(value, -grain.spread, grain.spread);
        return MaterialValue{mix(grain.dark, grain.light, w),
                             grain.rough_dark + (grain.rough_light - grain.rough_dark) * w, 0,
                             gradient * height};
    };
}

}  // namespace paint

bool colors_alike(const std::string& first, const std::string& second) {
    const auto seen = [](const std::string& name) {
        return glm::pow(paint::color_named(name), Vec3(.45f));
    };
    return glm::length(seen(first) - seen(second)) < .35f;
}

}  // namespace item3d
