#include "item3d/prior/data/shapes/things.h"

namespace item3d {
namespace {

using namespace sdf;

Shape house(Draw& u) {
    const float w = u(.5, .65), depth = u(.4, .6), h = u(.25, .42), roof = u(.35, .55);
    const float overhang = u(.03, .1), eaves = -.35f + h;
    const bool chimney = u.pick(2) == 1;
    const float slope = roof / (depth + overhang), scale = 1 / std::hypot(1.0f, slope);
    return {{{"",
              [=](const Vec3& p) {
                  // The walls reach up to the ridge, so that the gables are walls.
                  const float gable =
                      std::max(std::max((p.y - eaves - roof + .06f + std::abs(p.z) * slope) * scale,
                                        eaves - .02f - p.y),
                               std::abs(p.x) - w);
                  return merge({box(p, {0, -.35f, 0}, {w, h, depth}, .01f), gable});
              }},
             {"roof",
              [=](const Vec3& p) {
                  const float side = (p.y - eaves - roof + std::abs(p.z) * slope) * scale;
                  const float slab =
                      std::max(std::max(side, -side - .07f),
                               std::max(std::abs(p.x) - w - overhang, eaves - .09f - p.y));
                  if (!chimney) return slab;
                  return merge({slab, box(p, {w * .5f, eaves + roof * .6f, -depth * .4f},
                                          {.08f, roof * .5f, .08f})});
              }},
             {"door", [=](const Vec3& p) {
                  return box(p, {w * .1f, -.35f - h * .35f, depth}, {.1f, h * .6f, .03f});
              }}}};
}

Shape tower(Draw& u) {
    const float r = u(.3, .38), h = u(.6, .7), crown = r * u(1.12, 1.25), tip = u(.35, .5);
    const bool roofed = u.pick(2) == 1;
    const auto notches = static_cast<float>(6 + 2 * u.pick(2));
    const auto stone = [=](const Vec3& p) {
        const float body = cone(p, -.9f, h - .1f, r * 1.12f, r);
        const float top = cylinder(p, {0, h - .05f, 0}, crown, .14f);
        const float hollow = cylinder(p, {0, h + .12f, 0}, crown - .09f, .16f);
        const float battlement =
            std::max(.0f + h - .02f - p.y, .12f * std::sin(std::atan2(p.z, p.x) * notches));
        return merge({body, std::max(top, -std::min(hollow, battlement))});
    };
    if (!roofed) return whole(stone);
    return {{{"", [=](const Vec3& p) { return cone(p, -.9f, h - .1f, r * 1.12f, r); }},
             {"roof", [=](const Vec3& p) {
                  return cone(p, h - .12f, h - .12f + 2 * tip, crown * 1.1f, .01f);
              }}}};
}

Shape tree(Draw& u) {
    const float trunk = u(.08, .12), r = u(.26, .36);
    const bool fir = u.pick(2) == 1;
    const int seed = u.pick(1000);
    return {{{"",
              [=](const Vec3& p) {
                  if (fir)
                      return merge({cone(p, -.5f, .05f, r * 1.65f, .12f),
                                    cone(p, -.12f, .42f, r * 1.3f, .08f),
                                    cone(p, .25f, .92f, r, .01f)});
                  Random random(static_cast<std::uint64_t>(seed));
                  float d = sphere(p, {0, .35f, 0}, r * 1.25f);
                  for (int i = 0; i < 6; ++i) {
                      const float a = 2 * pi * static_cast<float>(i) / 6;
                      const auto lift = static_cast<float>(random.uniform(.05, .6));
                      d = smooth_merge(
                          .06f,
                          {d, sphere(p, {.33f * std::cos(a), lift, .33f * std::sin(a)}, r * .85f)});
                  }
                  return d;
              }},
             {"trunk", [=](const Vec3& p) {
                  return capsule(p, {0, -.85f, 0}, {0, .2f, 0}, trunk * 1.4f, trunk);
              }}}};
}

Shape cactus(Draw& u) {
    const float r = u(.17, .22), left = u(-.1, .15), right = u(-.1, .2), h = u(.7, .85);
    return {{{"",
              [=](const Vec3& p) {
                  const float rib = .018f * std::cos(std::atan2(p.z, p.x) * 10);
                  return smooth_merge(
                             .05f,
                             {capsule(p, {0, -.5f, 0}, {0, h, 0}, r) + rib,
                              capsule(p, {0, left, 0}, {.42f, left, 0}, r * .55f),
                              capsule(p, {.42f, left, 0}, {.42f, left + .32f, 0}, r * .6f),
                              capsule(p, {0, right, 0}, {-.4f, right, 0}, r * .55f),
                              capsule(p, {-.4f, right, 0}, {-.4f, right + .38f, 0}, r * .6f)}) *
                         .9f;
              }},
             {"pot", [=](const Vec3& p) {
                  return merge(
                      {cone(p, -.95f, -.45f, .26f, .36f), cylinder(p, {0, -.45f, 0}, .4f, .06f)});
              }}}};
}

Shape flower(Draw& u) {
    const int petals = 5 + u.pick(4);
    const float length = u(.38, .48), core = u(.14, .2), cup = u(-.25, .1);
    const float width = length * u(1.9, 2.4) / static_cast<float>(petals);
    return {{{"",
              [=](const Vec3& p) {
                  // The petals are around the z axis, so the flower faces +z.
                  const Vec3 q(p.x, p.y - .35f, p.z);
                  const float step = 2 * pi / static_cast<float>(petals);
                  const float turn = std::round(std::atan2(q.y, q.x) / step) * step;
                  const float c = std::cos(turn), s = std::sin(turn);
                  const Vec3 t(q.x * c + q.y * s, q.y * c - q.x * s,
                               q.z + cup * std::hypot(q.x, q.y));
                  return ellipsoid(t, {core + length * .42f, 0, 0}, {length * .6f, width, .055f}) *
                         .85f;
              }},
             {"center",
              [=](const Vec3& p) {
                  return ellipsoid(p, {0, .35f, .03f}, {core, core, .1f});
              }},
             {"stem", [=](const Vec3& p) {
                  const Vec3 q(p.x, p.y + .45f + .5f * std::abs(p.x), p.z);
                  return merge({capsule(p, {0, .3f, -.04f}, {0, -.95f, -.04f}, .045f),
                                ellipsoid(q, {.2f, .15f, -.04f}, {.22f, .08f, .035f}) * .85f});
              }}}};
}

Shape hat(Draw& u) {
    const float brim = u(.75, .9), crown = u(.38, .46), h = u(.25, .6), taper = u(-.06, .1);
    const float lift = u(0, .18);
    return {{{"",
              [=](const Vec3& p) {
                  const float edge = std::hypot(p.x, p.z);
                  const float curl = lift * std::max(edge - crown, 0.0f);
                  return smooth_merge(
                      .06f, {cylinder(p - Vec3(0, curl, 0), {0, -.3f, 0}, brim, .035f, .03f),
                             cone(p, -.3f, -.3f + 2 * h, crown, crown - taper) - .02f});
              }},
             {"band", [=](const Vec3& p) {
                  return cylinder(p, {0, -.17f, 0}, crown + .035f, .075f);
              }}}};
}

Shape boot(Draw& u) {
    const float shaft = u(.55, .85), w = u(.19, .24), length = u(.42, .52), sole = u(.05, .09);
    return {{{"",
              [=](const Vec3& p) {
                  const float top = -.45f + shaft * 1.5f;
                  const float leg = cone(p + Vec3(.25f, 0, 0), -.5f, top, w, w * 1.12f);
                  const float foot =
                      std::max(capsule({p.x, p.y, p.z * .92f}, {-.28f, -.5f, 0},
                                       {length - .1f, -.58f, 0}, w * 1.08f, w * .95f),
                               -.68f - p.y);
                  const float hollow =
                      cone(p + Vec3(.25f, 0, 0), top - .3f, top + .1f, w * .9f, w * .97f);
                  return std::max(smooth_merge(.12f, {leg, foot}), -hollow);
              }},
             {"sole", [=](const Vec3& p) {
                  const float foot = std::hypot(
                      std::max(std::abs(p.x - (length - .38f) * .5f) - (length + .18f) * .5f, 0.0f),
                      p.z);
                  const float heel = p.x < -.1f ? sole * 2.2f : sole;
                  return std::max((foot - w * 1.05f), std::abs(p.y + .66f + heel) - heel);
              }}}};
}

Shape bell(Draw& u) {
    const float mouth = u(.58, .7), waist = u(.3, .36), wall = .07f;
    const Lathe body({-.6f, -.5f, -.1f, .4f, .58f},
                     {mouth, mouth * .82f, waist * 1.15f, waist, .06f}, {0, .5f});
    return {{{"",
              [=](const Vec3& p) {
                  return std::max(body.distance(p),
                                  -body.distance(p / .86f + Vec3(0, .14f, 0)) * .86f);
              }},
             {"clapper",
              [=](const Vec3& p) {
                  return merge(
                      {sphere(p, {0, -.6f, 0}, .13f), capsule(p, {0, -.5f, 0}, {0, .3f, 0}, .03f)});
              }},
             {"handle", [=](const Vec3& p) {
                  return torus(p, {0, .68f + wall, 0}, .14f, .05f, 2);
              }}}};
}

Shape book(Draw& u) {
    const float w = u(.5, .62), h = u(.7, .82), thick = u(.1, .2);
    return {{{"",
              [=](const Vec3& p) {
                  const float covers = std::max(box(p, {0, 0, 0}, {w, h, thick + .035f}, .01f),
                                                -box(p, {.12f, 0, 0}, {w + .05f, h + 1, thick}));
                  return covers;
              }},
             {"pages", [=](const Vec3& p) {
                  return box(p, {0, 0, 0}, {w - .05f, h - .05f, thick + .005f});
              }}}};
}

Shape hammer(Draw& u) {
    const float head = u(.3, .38), r = u(.12, .16), grip = u(.055, .075);
    const bool claw = u.pick(2) == 1;
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q(p.y - .62f, p.x, p.z);  // the head lies along x
                  const float face = cylinder(q, {0, head * .5f, 0}, r, head * .55f, .03f);
                  if (!claw)
                      return merge({face, cylinder(q, {0, -head * .5f, 0}, r, head * .55f, .03f)});
                  const float bend = (p.x < 0 ? p.x * p.x * .9f : 0.0f);
                  return merge(
                      {face, box(p, {-head * .55f, .66f - bend, 0}, {head * .7f, .05f, r}, .03f)});
              }},
             {"handle", [=](const Vec3& p) {
                  return capsule(p, {0, .75f, 0}, {0, -.85f, 0}, grip * .85f, grip * 1.3f);
              }}}};
}

Shape umbrella(Draw& u) {
    const float r = u(.8, .92), h = u(.4, .55);
    const auto ribs = static_cast<float>(6 + 2 * u.pick(2));
    return {
        {{"",
          [=](const Vec3& p) {
              const float rib = std::abs(std::sin(std::atan2(p.z, p.x) * ribs * .5f));
              const float scallop = .08f * rib;
              const Vec3 q = p - Vec3(0, .2f, 0);
              const float dome = ellipsoid(q, {0, 0, 0}, {r, h, r});
              return std::max(std::max(dome, -dome - .06f), scallop - q.y);
          }},
         {"handle", [=](const Vec3& p) {
              const float hook = std::max(torus(p, {.14f, -.72f, 0}, .14f, .045f, 2), p.y + .72f);
              return merge({capsule(p, {0, .2f + h + .06f, 0}, {0, -.72f, 0}, .04f), hook});
          }}}};
}

Shape drum(Draw& u) {
    const float r = u(.55, .68), h = u(.32, .55);
    const auto zigzags = static_cast<float>(5 + u.pick(3));
    return {{{"",
              [=](const Vec3& p) {
                  return cylinder(p, {0, 0, 0}, r, h);
              }},
             {"rims",
              [=](const Vec3& p) {
                  const float angle = std::atan2(p.z, p.x) / pi * zigzags;
                  const float zig = std::abs(angle - 2 * std::floor(angle * .5f) - 1) * 2 - 1;
                  const float cord = std::max(std::abs(std::hypot(p.x, p.z) - r) - .03f,
                                              std::abs(p.y - zig * h * .85f) * .5f - .025f);
                  const Vec3 q(p.x, std::abs(p.y), p.z);
                  return merge({std::max(cylinder(q, {0, h - .03f, 0}, r + .05f, .075f),
                                         -(cylinder(q, {0, h, 0}, r - .02f, .3f))),
                                cord});
              }},
             {"skin", [=](const Vec3& p) {
                  return cylinder({p.x, std::abs(p.y), p.z}, {0, h, 0}, r - .01f, .03f);
              }}}};
}

Shape present(Draw& u) {
    const float a = u(.5, .62), h = u(.35, .55), band = u(.07, .11), bow = u(.17, .24);
    return {{{"",
              [=](const Vec3& p) {
                  return box(p, {0, -.15f, 0}, {a, h, a}, .015f);
              }},
             {"ribbon", [=](const Vec3& p) {
                  const float around = std::min(std::abs(p.x), std::abs(p.z)) - band;
                  const float wrap =
                      std::max(box(p, {0, -.15f, 0}, {a + .025f, h + .025f, a + .025f}), around);
                  const Vec3 q = fold(p, true, false);
                  const float y = h - .15f;
                  const Vec3 t((q.x - bow) * .8f + (q.y - y - bow * .6f) * .3f,
                               q.y - y - bow * .6f - q.x * .15f, q.z);
                  const float loop = std::hypot(std::hypot(t.x, t.y * 1.4f) - bow * .75f,
                                                std::max(std::abs(t.z) - band * .8f, 0.0f)) -
                                     .035f;
                  return merge({wrap, loop * .8f, sphere(p, {0, y + .06f, 0}, .09f)});
              }}}};
}

Shape crown(Draw& u) {
    const float r = u(.58, .68), h = u(.35, .5);
    const auto points = static_cast<float>(5 + u.pick(4));
    return {{{"",
              [=](const Vec3& p) {
                  const float angle = std::atan2(p.z, p.x) / (2 * pi) * points;
                  const float zig = std::abs(angle - std::floor(angle) - .5f) * 2;
                  const float rim = (1 - zig) * h - .02f;
                  const float flare = r + .15f * std::max(p.y + .4f, 0.0f);
                  return std::max(std::abs(std::hypot(p.x, p.z) - flare) - .045f,
                                  std::max((p.y - rim) * .6f, -.45f - p.y));
              }},
             {"jewels", [=](const Vec3& p) {
                  const float step = 2 * pi / points;
                  const float turn = (std::floor(std::atan2(p.z, p.x) / step) + .5f) * step;
                  const float tip = r + .15f * (h + .4f);
                  const float c = std::cos(turn), s = std::sin(turn);
                  return merge({sphere(p, {tip * c, h, tip * s}, .085f),
                                sphere(p, {(r + .06f) * c, -.24f, (r + .06f) * s}, .09f)});
              }}}};
}

Shape trophy(Draw& u) {
    const float cup = u(.38, .46), foot = u(.26, .34);
    const Lathe body({-.5f, -.45f, -.3f, -.1f, .1f, .5f, .8f},
                     {.2f, .18f, .06f, .08f, cup * .7f, cup, cup * 1.05f}, {0, .5f});
    return {{{"",
              [=](const Vec3& p) {
                  const float hollow = ellipsoid(p, {0, .85f, 0}, {cup * .92f, .55f, cup * .92f});
                  return std::max(body.distance(p), -hollow);
              }},
             {"handles",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, true, false);
                  return std::max(
                      torus({q.x * 1.1f, q.y * .85f, q.z}, {cup * 1.05f, .38f, 0}, .22f, .045f, 2),
                      cup * .8f - q.x);
              }},
             {"base", [=](const Vec3& p) {
                  return box(p, {0, -.68f, 0}, {foot, .2f, foot}, .02f);
              }}}};
}

Shape alarm_clock(Draw& u) {
    const float r = u(.55, .65), depth = u(.14, .22), bells = u(.17, .23);
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, true, false);
                  const Vec3 flat(p.x, p.z, p.y);
                  const float rim = std::max(cylinder(flat, Vec3(0.0f), r, depth, .04f),
                                             -cylinder(flat, {0, depth, 0}, r - .09f, .07f));
                  return merge({rim,
                                capsule(q, {r * .5f, -r * .75f, 0}, {r * .7f, -r - .12f, 0}, .06f),
                                capsule(q, {r * .5f, r * .7f, 0}, {r * .6f, r * .95f, 0}, .04f)});
              }},
             {"bells",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, true, false) - Vec3(r * .6f, r * .95f, 0);
                  return std::max(glm::length(q) - bells, -glm::dot(q, Vec3(.55f, .83f, 0)));
              }},
             {"face",
              [=](const Vec3& p) {
                  return cylinder({p.x, p.z - depth + .07f, p.y}, Vec3(0.0f), r - .09f, .02f, 0);
              }},
             {"hands", [=](const Vec3& p) {
                  const float z = depth - .03f;
                  return merge({capsule(p, {0, 0, z}, {0, r * .62f, z}, .035f, .025f),
                                capsule(p, {0, 0, z}, {r * .38f, r * .2f, z}, .04f, .03f)});
              }}}};
}

Shape anvil(Draw& u) {
    const float l = u(.45, .55), w = u(.18, .24), horn = u(.35, .45);
    return whole([=](const Vec3& p) {
        const float neck = .5f + 1.4f * p.y * p.y * 2;
        return merge(
            {box(p, {-.12f, .32f, 0}, {l, .14f, w}, .02f),
             capsule({p.x, p.y, p.z}, {l - .15f, .33f, 0}, {l + horn, .38f, 0}, .15f, .03f),
             box({p.x / neck, p.y, p.z / neck}, {-.05f, -.1f, 0}, {.32f, .36f, w}, .02f) * .5f,
             box(p, {-.05f, -.5f, 0}, {.48f, .1f, w * 1.5f}, .02f)});
    });
}

Shape guitar(Draw& u) {
    const float low = u(.36, .42), high = low * u(.7, .8), depth = u(.08, .11);
    const auto plate = [=](const Vec3& p, float inset, float half) {
        const float outline = smooth_merge(.16f, {std::hypot(p.x, p.y + .5f) - low + inset,
                                                  std::hypot(p.x, p.y + .02f) - high + inset});
        return std::max(outline, std::abs(p.z) - half);
    };
    return {{{"",
              [=](const Vec3& p) {
                  return std::max(plate(p, 0, depth),
                                  -cylinder({p.x, p.z - depth, p.y + .2f}, Vec3(0.0f), .12f, .06f));
              }},
             {"neck", [=](const Vec3& p) {
                  return merge({box(p, {0, .4f, depth}, {.05f, .48f, .035f}, .01f),
                                box(p, {0, .93f, depth - .02f}, {.085f, .1f, .03f}, .01f),
                                box(p, {0, -.6f, depth + .01f}, {.14f, .03f, .025f}, .01f)});
              }}}};
}

Shape key(Draw& u) {
    const float ring = u(.22, .28), tube = u(.06, .08), shaft = u(.055, .075);
    const int teeth = 2 + u.pick(2);
    return whole([=](const Vec3& p) {
        float d = merge({torus(p, {0, .58f, 0}, ring, tube, 2),
                         capsule(p, {0, .58f - ring, 0}, {0, -.85f, 0}, shaft)});
        for (int i = 0; i < teeth; ++i)
            d = std::min(d, box(p, {.15f, -.82f + .17f * static_cast<float>(i), 0},
                                {.14f - .03f * static_cast<float>(i % 2), .055f, .045f}, .01f));
        return d;
    });
}

}  // namespace

std::vector<ShapeMaker> thing_shapes() {
    return {{{"house", {"house", "cottage"}}, house},
            {{"tower", {"tower"}}, tower},
            {{"tree", {"tree"}}, tree},
            {{"cactus", {"cactus"}}, cactus},
            {{"flower", {"flower"}}, flower},
            {{"hat", {"hat"}}, hat},
            {{"boot", {"boot", "shoe"}}, boot},
            {{"bell", {"bell"}}, bell},
            {{"book", {"book"}}, book},
            {{"hammer", {"hammer"}}, hammer},
            {{"umbrella", {"umbrella", "parasol"}}, umbrella},
            {{"drum", {"drum"}}, drum},
            {{"present", {"present", "gift"}}, present},
            {{"crown", {"crown"}}, crown},
            {{"trophy", {"trophy"}}, trophy},
            {{"clock", {"clock"}}, alarm_clock},
            {{"anvil", {"anvil"}}, anvil},
            {{"guitar", {"guitar"}}, guitar},
            {{"key", {"key"}}, key}};
}

}  // namespace item3d
