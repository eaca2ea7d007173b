#include "item3d/prior/data/materials/makers.h"

namespace item3d::paint {
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

std::string one_color(Random& random, const MaterialWish& wish) {
    const auto& colors = plain_colors();
    const auto any = random.index(static_cast<std::int64_t>(colors.size()));
    return wish.color.empty() ? colors[static_cast<std::size_t>(any)].name : wish.color;
}

std::pair<std::string, std::string> two_colors(Random& random, const MaterialWish& wish) {
    // White is the most usual second colour of patterns. It also differs clearly from most others.
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
    // The length of the noise's gradient is about its frequency, so this height gives the requested
    // slope.
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

}  // namespace item3d::paint
