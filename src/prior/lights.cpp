#include "item3d/prior/lights.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/prior/workers.h"
#include "item3d/scene/environment.h"

#include <array>
#include <atomic>
#include <mutex>

namespace item3d {
namespace {

constexpr int map_height = 96;

float draw(Random& random, double low, double high) {
    return static_cast<float>(random.uniform(low, high));
}

struct SoftBox {
    Vec3 direction, right, up;
    float half_width, half_height;  ///< tangents of half the angles
    bool round;
    Vec3 radiance;
};

Vec3 direction_of(float azimuth, float elevation) {
    return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
            std::cos(elevation) * std::cos(azimuth)};
}

SoftBox random_box(Random& random, float low, float high, float strength, const Vec3& tint) {
    SoftBox box;
    const float azimuth = draw(random, 0, 2 * pi);
    box.direction = direction_of(azimuth, glm::radians(draw(random, low, high)));
    box.right = glm::normalize(glm::cross(Vec3(0, 1, 0), box.direction));
    box.up = glm::cross(box.direction, box.right);
    box.half_width = draw(random, .12, .7);
    box.half_height = box.half_width * draw(random, .5, 2);
    box.round = random.chance(.3);
    // The same power through a small box is brighter.
    box.radiance =
        tint * strength * draw(random, .4, 1) / std::pow(box.half_width * box.half_height, .7f);
    return box;
}

/// A gradient room with one to five soft boxes. contrast: how dark the room is beside its boxes.
Image random_room(Random& random, float contrast) {
    const float warmth = static_cast<float>(random.normal(0, .05));
    const Vec3 tint(1 + warmth, 1, 1 - warmth);
    const Vec3 sky = tint * draw(random, .25, .8) / contrast;
    const Vec3 ground = sky * draw(random, .25, .8);
    const float horizon = draw(random, -.15, .15), softness = draw(random, .05, .8);
    std::vector<SoftBox> boxes;
    const auto count = 1 + random.index(4);
    for (std::int64_t i = 0; i < count; ++i)
        boxes.push_back(random_box(random, 0, 70, draw(random, .6, 1.6), tint));
    if (random.chance(.5)) boxes.push_back(random_box(random, 75, 89, draw(random, .6, 1.4), tint));
    // Dark panels are what photographers of metal use ("flags").
    if (random.chance(.4)) {
        boxes.push_back(random_box(random, -10, 40, 1, tint));
        boxes.back().radiance = sky * .1f;
    }

    Image map(2 * map_height, map_height, 3);
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            const Vec3 d = equirectangular_direction((static_cast<float>(x) + .5f) / map.width,
                                                     (static_cast<float>(y) + .5f) / map.height);
            const float w = glm::clamp((d.y - horizon) / softness * .5f + .5f, 0.0f, 1.0f);
            Vec3 radiance = glm::mix(ground, sky, w);
            for (const SoftBox& box : boxes) {
                const float facing = glm::dot(d, box.direction);
                if (facing <= .05f) continue;
                const float u = glm::dot(d, box.right) / facing / box.half_width;
                const float v = glm::dot(d, box.up) / facing / box.half_height;
                const float inside = box.round ? u * u + v * v : std::max(u * u, v * v);
                const float edge = glm::clamp((1.15f - inside) / .3f, 0.0f, 1.0f);
                radiance = glm::mix(radiance, box.radiance, edge);
            }
            for (int c = 0; c < 3; ++c)
                map.at(x, y, c) = radiance[c];
        }
    }
    return map;
}

Image turned_preset(Random& random, const std::string& name) {
    return adjust_light(make_light_preset(name, map_height), draw(random, 0, 360), 0);
}

/// Scales the light so that the brightest white surface has that radiance.
void normalise(EnvironmentLight& light, float brightest) {
    const auto luminance = light.diffuse.mean(-1).max().item<float>();
    const float factor = brightest / std::max(luminance, 1e-6f);
    light.diffuse = light.diffuse * factor;
    for (torch::Tensor& level : light.specular)
        level = level * factor;
}

}  // namespace

const std::vector<std::string>& light_kinds() {
    static const std::vector<std::string> kinds{"studio", "sunset",   "night",
                                                "bright", "overcast", "noon"};
    return kinds;
}

TrainingLight make_training_light(Random& random, const std::string& kind, int size) {
    Image map;
    float brightest = 1.0f;
    std::vector<std::string> phrases;
    if (kind == "plain") {
        const double which = random.uniform();
        map = which < .7    ? random_room(random, 1)
              : which < .82 ? turned_preset(random, "studio")
              : which < .91 ? turned_preset(random, "overcast")
                            : turned_preset(random, "noon");
        brightest = draw(random, .85, 1.1);
        phrases = {""};
    } else if (kind == "studio") {
        map = random.chance(.5) ? turned_preset(random, "studio") : random_room(random, 5);
        brightest = draw(random, .85, 1.05);
        phrases = {" in a studio", " in a studio", " under studio light"};
    } else if (kind == "bright") {
        map = random_room(random, .5f);
        brightest = draw(random, 1.3, 1.55);
        phrases = {" in bright light"};
    } else if (kind == "sunset") {
        map = turned_preset(random, "sunset");
        brightest = draw(random, .55, .85);
        phrases = {" at sunset"};
    } else if (kind == "night") {
        map = turned_preset(random, "night");
        brightest = draw(random, .14, .26);
        phrases = {" at night", " at night", " in the dark"};
    } else if (kind == "overcast") {
        map = turned_preset(random, "overcast");
        brightest = draw(random, .6, .8);
        phrases = {" on an overcast day"};
    } else {
        ITEM3D_CHECK(kind == "noon", "no light is called " + kind);
        map = turned_preset(random, "noon");
        brightest = draw(random, .95, 1.15);
        phrases = {" at noon", " in the sun"};
    }
    torch::NoGradGuard no_grad;
    TrainingLight result{kind, phrases, prefilter(map, size)};
    normalise(result.light, brightest);
    return result;
}

std::vector<TrainingLight> make_training_lights(std::uint64_t seed, int count, int threads) {
    struct Share {
        const char* kind;
        double share;
    };
    static constexpr std::array<Share, 7> shares{{{"plain", .64},
                                                  {"studio", .07},
                                                  {"sunset", .07},
                                                  {"night", .07},
                                                  {"bright", .05},
                                                  {"overcast", .05},
                                                  {"noon", .05}}};
    std::vector<TrainingLight> lights(static_cast<std::size_t>(count));
    std::atomic<std::int64_t> done = 0;
    std::mutex mutex;
    Progress progress("lights", count);
    run_workers(count, threads, [&](std::int64_t i) {
        // In turn rather than at random, so that a few hundred lights keep the proportions.
        double at = (static_cast<double>(i) + .5) / count;
        const char* kind = shares[0].kind;
        for (const Share& share : shares) {
            kind = share.kind;
            if ((at -= share.share) < 0) break;
        }
        Random random(seed, static_cast<std::uint64_t>(i));
        lights[static_cast<std::size_t>(i)] = make_training_light(random, kind);
        const std::lock_guard lock(mutex);
        progress.update(++done);
    });
    return lights;
}

}  // namespace item3d
