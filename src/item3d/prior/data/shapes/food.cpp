#include "item3d/prior/data/shapes/food.h"

namespace item3d {
namespace {

using namespace sdf;

/// Returns the distance to `count` leaves around the y axis at the height y. Their tips point
/// outwards and hang down by `droop`.
float leaf_star(const Vec3& p, int count, float y, float length, float width, float droop) {
    const float step = 2 * pi / static_cast<float>(count);
    const float angle = std::atan2(p.z, p.x);
    const float turn = std::round(angle / step) * step;
    const float c = std::cos(turn), s = std::sin(turn);
    const Vec3 q(p.x * c + p.z * s, p.y - y + droop * std::hypot(p.x, p.z), p.z * c - p.x * s);
    return ellipsoid(q, {length * .5f, 0, 0}, {length * .55f, .03f, width}) * .8f;
}

Shape apple(Draw& u) {
    const float w = u(.68, .78);
    const Lathe body({-.68f, -.66f, -.3f, .2f, .55f, .62f}, {.15f, .3f, w * .88f, w, w * .6f, .02f},
                     {0, .45f});
    const bool leaf = u.pick(2) == 1;
    return {{{"", turned(body)},
             {"stem", [=](const Vec3& p) {
                  const float stem = capsule(p, {0, .5f, 0}, {.06f, .85f, 0}, .04f);
                  return leaf ? std::min(stem, ellipsoid(p - Vec3(0, p.x * .25f, 0), {.24f, .7f, 0},
                                                         {.22f, .035f, .11f}))
                              : stem;
              }}}};
}

Shape pear(Draw& u) {
    const float wide = u(.5, .6), narrow = u(.2, .28);
    return {{{"",
              [=](const Vec3& p) {
                  return smooth_merge(
                      .35f, {sphere(p, {0, -.3f, 0}, wide), sphere(p, {0, .38f, 0}, narrow)});
              }},
             {"stem", [=](const Vec3& p) {
                  return capsule(p, {0, .5f, 0}, {.07f, .85f, 0}, .035f);
              }}}};
}

Shape banana(Draw& u) {
    const float ring = u(.75, .95), thick = u(.17, .22), half = u(.75, .95);
    const auto along = [=](const Vec3& p, float& angle) {
        angle = std::atan2(p.x, -(p.y - ring * .75f));
        return std::hypot(std::hypot(p.x, p.y - ring * .75f) - ring, p.z);
    };
    return {{{"",
              [=](const Vec3& p) {
                  float angle;
                  const float off = along(p, angle);
                  const float part = std::min(std::abs(angle) / half, 1.0f);
                  const float over = std::max(std::abs(angle) - half, 0.0f) * ring;
                  return std::hypot(off, over) * .8f -
                         thick * std::sqrt(std::max(1 - part * part * .8f, .05f)) * .8f;
              }},
             {"tips",
              [=](const Vec3& p) {
                  float angle;
                  const float off = along(p, angle);
                  const float end = std::abs(angle) - half;
                  const float length = angle > 0 ? .2f : .06f;
                  return std::hypot(off, std::max(std::abs(end * ring) - length, 0.0f)) - .065f;
              }}},
            .04f};
}

Shape pumpkin(Draw& u) {
    const float r = u(.6, .72), h = u(.45, .58), depth = u(.05, .09);
    const auto ribs = static_cast<float>(8 + u.pick(4));
    return {{{"",
              [=](const Vec3& p) {
                  const float rib = std::abs(std::sin(std::atan2(p.z, p.x) * ribs * .5f));
                  const float bulge = 1 - depth * 2 * (1 - std::sqrt(rib));
                  const float dent = .25f * std::exp(-8 * (p.x * p.x + p.z * p.z));
                  const Vec3 q(p.x / bulge, p.y > 0 ? p.y + dent : p.y - dent * .5f, p.z / bulge);
                  return ellipsoid(q, {0, -.15f, 0}, {r, h, r}) * .7f;
              }},
             {"stem", [=](const Vec3& p) {
                  return capsule(p, {0, h - .35f, 0}, {.1f, h + .12f, .03f}, .1f, .06f);
              }}}};
}

Shape strawberry(Draw& u) {
    const float r = u(.5, .6);
    const Lathe body({-.85f, -.7f, -.2f, .3f, .5f}, {.04f, .2f, r * .8f, r, .15f}, {0, .55f});
    const int leaves = 5 + u.pick(3);
    return {{{"", turned(body)}, {"leaves", [=](const Vec3& p) {
                                      return std::min(
                                          leaf_star(p, leaves, .56f, r * 1.1f, .15f, .3f),
                                          capsule(p, {0, .5f, 0}, {.05f, .75f, 0}, .05f));
                                  }}}};
}

Shape carrot(Draw& u) {
    const float r = u(.24, .32), bend = u(-.08, .08);
    const Lathe body({-.95f, -.85f, -.2f, .3f, .4f}, {.02f, .06f, r * .75f, r, r * .5f}, {0, .7f});
    return {
        {{"",
          [=](const Vec3& p) { return body.distance(p - Vec3(bend * p.y * p.y, 0, 0)) * .95f; }},
         {"leaves", [=](const Vec3& p) {
              float d = 1e9f;
              for (int i = 0; i < 5; ++i) {
                  const float a = 2 * pi * static_cast<float>(i) / 5;
                  const Vec3 tip(.25f * std::cos(a), .85f + .05f * static_cast<float>(i % 2),
                                 .25f * std::sin(a));
                  d = std::min(d, capsule(p, {0, .35f, 0}, tip, .035f, .085f));
              }
              return d;
          }}}};
}

Shape pineapple(Draw& u) {
    const float r = u(.4, .48), h = u(.5, .6);
    return {{{"",
              [=](const Vec3& p) {
                  // Two families of spirals form rhombic scales.
                  const float a = std::atan2(p.z, p.x) * 8, y = p.y * 12;
                  const float scale = std::cos(a + y) + std::cos(a - y);
                  return (ellipsoid(p, {0, -.3f, 0}, {r, h, r}) - .018f * scale) * .8f;
              }},
             {"leaves", [=](const Vec3& p) {
                  float d = 1e9f;
                  for (int i = 0; i < 9; ++i) {
                      const float a = 2.4f * static_cast<float>(i);
                      const float out = .34f - .03f * static_cast<float>(i);
                      const Vec3 tip(out * std::cos(a), h + .08f + .05f * static_cast<float>(i),
                                     out * std::sin(a));
                      d = std::min(d, capsule(p, {0, h - .36f, 0}, tip, .1f, .02f));
                  }
                  return d;
              }}}};
}

Shape mushroom(Draw& u) {
    const float radius = u(.6, .8), h = u(.35, .55), stem = u(.16, .27);
    return {{{"", [=](const Vec3& p) { return cone(p, -.75f, .2f, stem * 1.25f, stem); }},
             {"cap",
              [=](const Vec3& p) {
                  return std::max(ellipsoid(p, {0, .15f, 0}, {radius, h, radius}), .12f - p.y);
              }}},
            .1f};
}

Shape donut(Draw& u) {
    const float ring = u(.5, .58), tube = u(.2, .3);
    return {{{"",
              [=](const Vec3& p) {
                  return torus(p, {0, 0, 0}, ring, tube);
              }},
             {"icing", [=](const Vec3& p) {
                  const float edge = .03f * std::sin(std::atan2(p.z, p.x) * 7);
                  return std::max(torus(p, {0, 0, 0}, ring, tube + .025f), .03f + edge - p.y);
              }}}};
}

Shape cupcake(Draw& u) {
    const float r = u(.42, .5), top = u(.5, .6);
    const auto turns = static_cast<float>(2 + u.pick(2));
    return {{{"",
              [=](const Vec3& p) {
                  const float fold = .025f * std::cos(std::atan2(p.z, p.x) * 16);
                  return cone(p, -.8f, -.1f, r * .72f, r) - fold;
              }},
             {"icing", [=](const Vec3& p) {
                  const float y = (p.y + .12f) / .8f;
                  const float wave = .05f * std::abs(std::sin(y * turns * pi));
                  const float radius = top * std::sqrt(std::max(1 - y, 0.0f)) + wave;
                  return std::max((std::hypot(p.x, p.z) - radius) * .6f,
                                  std::max(-.14f - p.y, p.y - .68f));
              }}}};
}

Shape cake(Draw& u) {
    const float r = u(.6, .75), h = u(.22, .3), plate = r * u(1.15, 1.3);
    const int tiers = 1 + u.pick(2), drops = 8 + u.pick(5);
    return {{{"",
              [=](const Vec3& p) {
                  const float low = cylinder(p, {0, -.4f + h, 0}, r, h, .04f);
                  if (tiers == 1) return low;
                  return std::min(low, cylinder(p, {0, -.4f + 3 * h, 0}, r * .65f, h, .04f));
              }},
             {"icing",
              [=](const Vec3& p) {
                  float d = 1e9f;
                  for (int i = 0; i < tiers; ++i) {
                      const float radius = i == 0 ? r : r * .65f;
                      const float y = -.4f + h * static_cast<float>(2 + 2 * i);
                      const float wave =
                          .35f + .3f * std::sin(std::atan2(p.z, p.x) * static_cast<float>(drops));
                      d = std::min(d, std::max(cylinder(p, {0, y - h * .4f, 0}, radius + .03f,
                                                        h * .4f + .04f, .03f),
                                               y - h * wave - p.y));
                  }
                  return d;
              }},
             {"plate", [=](const Vec3& p) {
                  return cylinder(p, {0, -.44f, 0}, plate, .04f);
              }}}};
}

}  // namespace

std::vector<ShapeMaker> food_shapes() {
    return {{{"apple", {"apple"}}, apple},
            {{"pear", {"pear"}}, pear},
            {{"banana", {"banana"}}, banana},
            {{"pumpkin", {"pumpkin"}}, pumpkin},
            {{"strawberry", {"strawberry"}}, strawberry},
            {{"carrot", {"carrot"}}, carrot},
            {{"pineapple", {"pineapple"}}, pineapple},
            {{"mushroom", {"mushroom", "toadstool"}}, mushroom},
            {{"donut", {"donut"}}, donut},
            {{"cupcake", {"cupcake", "muffin"}}, cupcake},
            {{"cake", {"cake"}}, cake}};
}

}  // namespace item3d
