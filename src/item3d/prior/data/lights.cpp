#include "item3d/prior/data/lights.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/lighting/environment.h"
#include "item3d/tensors/workers.h"

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
    float half_width, half_height;  ///< tangents of the half angles
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
    // The same power through a smaller box is brighter.
    box.radiance =
        tint * strength * draw(random, .4, 1) / std::pow(box.half_width * box.half_height, .7f);
    return box;
}

/// Surroundings of an object: a gradient from ground to sky, and boxes of light in front of it.
struct Room {
    Vec3 sky, ground;
    float horizon = 0, softness = .5f;
    std::vector<SoftBox> boxes{};

    Image draw() const;
};

Image Room::draw() const {
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

/// Draws a gradient room with one to five soft boxes. contrast: divisor of the room's brightness;
/// the boxes keep theirs.
Image random_room(Random& random, float contrast) {
    const float warmth = static_cast<float>(random.normal(0, .05));
    const Vec3 tint(1 + warmth, 1, 1 - warmth);
    Room room;
    room.sky = tint * draw(random, .25, .8) / contrast;
    room.ground = room.sky * draw(random, .25, .8);
    room.horizon = draw(random, -.15, .15);
    room.softness = draw(random, .05, .8);
    const auto count = 1 + random.index(4);
    for (std::int64_t i = 0; i < count; ++i)
        room.boxes.push_back(random_box(random, 0, 70, draw(random, .6, 1.6), tint));
    if (random.chance(.5))
        room.boxes.push_back(random_box(random, 75, 89, draw(random, .6, 1.4), tint));
    // Some rooms have dark panels ("flags"), which photographers of metal use.
    if (random.chance(.4)) {
        room.boxes.push_back(random_box(random, -10, 40, 1, tint));
        room.boxes.back().radiance = room.sky * .1f;
    }
    return room.draw();
}

/// Draws a dark room with a few small warm flames.
Image candle_room(Random& random) {
    Room room{Vec3(.05f, .022f, .008f), Vec3(.02f, .009f, .004f)};
    const auto count = 2 + random.index(3);
    for (std::int64_t i = 0; i < count; ++i) {
        room.boxes.push_back(random_box(random, -5, 35, 1, {1, .5f, .16f}));
        SoftBox& flame = room.boxes.back();
        flame.half_width = draw(random, .1, .2);
        flame.half_height = flame.half_width * 1.6f;
        flame.round = true;
        flame.radiance = Vec3(1, .5f, .16f) * draw(random, 4, 9);
    }
    return room.draw();
}

/// Draws coloured tubes in a dark room: one colour from each side.
Image neon_room(Random& random) {
    Room room{Vec3(.03f, .015f, .06f), Vec3(.02f, .015f, .035f)};
    const float side = draw(random, 0, 2 * pi);
    const std::array<Vec3, 3> tones{Vec3(1, .02f, .55f), Vec3(.02f, .55f, 1), Vec3(.35f, .04f, 1)};
    for (std::size_t i = 0; i < tones.size(); ++i) {
        SoftBox tube = random_box(random, 0, 40, 1, tones[i]);
        const float azimuth = side + static_cast<float>(i) * 2.4f + draw(random, -.4, .4);
        tube.direction = direction_of(azimuth, draw(random, 0, .6));
        tube.right = glm::normalize(glm::cross(Vec3(0, 1, 0), tube.direction));
        tube.up = glm::cross(tube.direction, tube.right);
        tube.half_width = draw(random, .15, .35);
        tube.half_height = draw(random, .6, 1.2);
        tube.round = false;
        tube.radiance = tones[i] * draw(random, 2.5, 4);
        room.boxes.push_back(tube);
    }
    return room.draw();
}

/// Draws a black room with one lamp above and to the side.
Image spotlight_room(Random& random) {
    Room room{Vec3(.012f), Vec3(.006f)};
    room.boxes.push_back(random_box(random, 40, 70, 1, Vec3(1, .97f, .9f)));
    SoftBox& lamp = room.boxes.back();
    lamp.half_width = lamp.half_height = draw(random, .12, .22);
    lamp.round = true;
    lamp.radiance = Vec3(1, .97f, .9f) * 25.0f;
    return room.draw();
}

/// Draws light that is blue-green from above and dark below.
Image sea_room(Random& random) {
    Room room{Vec3(.06f, .5f, .62f) * draw(random, .8, 1.2), Vec3(.004f, .05f, .11f)};
    room.softness = 1;
    room.boxes.push_back(random_box(random, 65, 88, 1.6f, {.35f, 1, .95f}));
    return room.draw();
}

Image turned_preset(Random& random, const std::string& name) {
    return adjust_light(make_light_preset(name, map_height), draw(random, 0, 360), 0);
}

/// Draws an overcast sky, greyer and cooler than the preset "overcast". Priors mistook that preset
/// for a studio.
Image cloudy_sky(Random& random) {
    Image map = turned_preset(random, "overcast");
    const Vec3 tint = glm::mix(Vec3(.9f, 1, 1.1f), Vec3(.72f, .95f, 1.22f), draw(random, 0, 1));
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x)
            for (int c = 0; c < 3; ++c)
                map.at(x, y, c) *= tint[c];
    return map;
}

/// Scales the light so that the brightest white surface has the given radiance.
void normalise(EnvironmentLight& light, float brightest) {
    const auto luminance = light.diffuse.mean(-1).max().item<float>();
    const float factor = brightest / std::max(luminance, 1e-6f);
    light.diffuse = light.diffuse * factor;
    for (at::Tensor& level : light.specular)
        level = level * factor;
}

/// Kind of light with its drawing function and phrases.
struct LightKind {
    const char* name;
    double share;  ///< fraction of the training data
    std::vector<std::string> phrases;
    Image (*draw)(Random&);
    double low, high;  ///< radiance of the brightest white surface
};

Image plain_room(Random& random) {
    const double which = random.uniform();
    return which < .7    ? random_room(random, 1)
           : which < .82 ? turned_preset(random, "studio")
           : which < .91 ? turned_preset(random, "overcast")
                         : turned_preset(random, "noon");
}

const std::vector<LightKind>& all_lights() {
    static const std::vector<LightKind> kinds{
        {"plain", .58, {""}, plain_room, .85, 1.1},
        {"studio",
         .06,
         {" in a studio", " in a studio", " under studio light"},
         [](Random& r) { return r.chance(.5) ? turned_preset(r, "studio") : random_room(r, 5); },
         .85,
         1.05},
        {"sunset",
         .05,
         {" at sunset", " at sunset", " in the evening sun"},
         [](Random& r) { return turned_preset(r, "sunset"); },
         .55,
         .85},
        {"night",
         .05,
         {" at night", " at night", " in the dark", " by moonlight"},
         [](Random& r) { return turned_preset(r, "night"); },
         .14,
         .26},
        {"bright",
         .04,
         {" in bright light", " in bright light", " brightly lit"},
         [](Random& r) { return random_room(r, .5f); },
         1.3,
         1.55},
        {"overcast",
         .04,
         {" on an overcast day", " on an overcast day", " on a cloudy day"},
         cloudy_sky,
         .42,
         .58},
        {"noon",
         .04,
         {" at noon", " in the sun"},
         [](Random& r) { return turned_preset(r, "noon"); },
         .95,
         1.15},
        {"candlelight",
         .04,
         {" by candlelight", " by candlelight", " in candlelight"},
         candle_room,
         .4,
         .65},
        {"neon",
         .035,
         {" in neon light", " in neon light", " under neon lights"},
         neon_room,
         .5,
         .8},
        {"spotlight", .03, {" under a spotlight", " in a spotlight"}, spotlight_room, .85, 1.1},
        {"underwater", .035, {" underwater", " underwater", " under the sea"}, sea_room, .4, .65}};
    return kinds;
}

const LightKind& light_named(const std::string& name) {
    for (const LightKind& kind : all_lights())
        if (name == kind.name) return kind;
    ITEM3D_CHECK(false, "unknown light " + name);
    return all_lights()[0];
}

}  // namespace

const std::vector<std::string>& light_kinds() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const LightKind& kind : all_lights())
            if (kind.name != std::string("plain")) all.emplace_back(kind.name);
        return all;
    }();
    return names;
}

const std::vector<std::string>& light_phrases(const std::string& kind) {
    return light_named(kind).phrases;
}

TrainingLight make_training_light(Random& random, const std::string& kind, int size) {
    const LightKind& known = light_named(kind);
    const Image map = known.draw(random);
    const float brightest = draw(random, known.low, known.high);
    at::NoGradGuard no_grad;
    TrainingLight result{kind, known.phrases, prefilter(map, size), sky_light(map)};
    normalise(result.light, brightest);
    return result;
}

std::vector<TrainingLight> make_training_lights(std::uint64_t seed, int count, int threads) {
    std::vector<TrainingLight> lights(static_cast<std::size_t>(count));
    std::atomic<std::int64_t> done = 0;
    std::mutex mutex;
    Progress progress("lights", count);
    run_workers(count, threads, [&](std::int64_t i) {
        // The kinds are stratified rather than random, so that a few hundred lights keep the
        // proportions.
        double at = (static_cast<double>(i) + .5) / count;
        const char* kind = nullptr;
        for (const LightKind& each : all_lights()) {
            kind = each.name;
            if ((at -= each.share) < 0) break;
        }
        Random random(seed, static_cast<std::uint64_t>(i));
        lights[static_cast<std::size_t>(i)] = make_training_light(random, kind);
        const std::lock_guard lock(mutex);
        progress.update(++done);
    });
    return lights;
}

}  // namespace item3d
