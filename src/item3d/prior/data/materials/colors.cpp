#include "item3d/prior/data/materials/colors.h"

#include "item3d/core/error.h"

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

std::array<float, 2> metal_roughness_range(const std::string& metal) {
    if (metal == "chrome") return {.04f, .12f};
    if (metal == "iron") return {.4f, .6f};
    return {.12f, .38f};
}

float metal_roughness(const std::string& metal) {
    const auto [low, high] = metal_roughness_range(metal);
    return (low + high) / 2;
}

Vec3 color_named(const std::string& name) {
    for (const auto* colors : {&plain_colors(), &metal_colors()})
        for (const PlainColor& color : *colors)
            if (color.name == name) return color.linear;
    ITEM3D_CHECK(false, "unknown colour " + name);
    return {};
}

bool colors_alike(const std::string& first, const std::string& second) {
    const auto seen = [](const std::string& name) {
        return glm::pow(color_named(name), Vec3(.45f));
    };
    return glm::length(seen(first) - seen(second)) < .35f;
}

}  // namespace item3d
