#include "item3d/prior/data/shapes/vessels.h"

namespace item3d {
namespace {

using namespace sdf;

Shape mug(Draw& u) {
    const float r = u(.45, .6), h = u(.5, .65), wall = u(.06, .09), ring = u(.24, .36);
    const float taper = u(-.08, .1), y = u(-.08, .08), tube = u(.05, .08);
    const Lathe body({-h, 0, h}, {r - taper, r - taper * .4f, r}, {wall, .8f});
    return {{{"", turned(body)}, {"handle", [=](const Vec3& p) {
                                      const Vec3 q(p.x, (p.y - y) * .85f, p.z);
                                      return std::max(
                                          torus(q, {r - taper * .4f + .02f, 0, 0}, ring, tube, 2),
                                          (r - taper) * .9f - std::hypot(p.x, p.z));
                                  }}}};
}

Shape vase(Draw& u) {
    return whole(turned(Lathe(
        {-.85f, -.5f, -.1f, .3f, .6f, .85f},
        {u(.2, .35), u(.35, .55), u(.35, .6), u(.2, .5), u(.15, .25), u(.22, .4)}, {.1f, .6f})));
}

Shape bowl(Draw& u) {
    const float radius = u(.7, .85), h = u(.3, .45), base = u(.25, .35);
    return whole(turned(
        Lathe({-h, -h + .08f, 0, h}, {base, base * 1.1f, radius * .8f, radius}, {.07f, .5f})));
}

Shape bottle(Draw& u) {
    const float b = u(.26, .38), n = u(.09, .14), s = u(.05, .3);
    const Lathe body({-.9f, -.85f, s - .1f, s + .25f, .8f, .82f, .9f},
                     {b * .9f, b, b, n, n, n * 1.25f, n * 1.25f}, {0, .5f});
    const float cap = n * u(1.5, 1.8);
    return {{{"", turned(body)}, {"cap", [=](const Vec3& p) {
                                      return cylinder(p, {0, .86f, 0}, cap, .1f);
                                  }}}};
}

Shape teapot(Draw& u) {
    const float w = u(.48, .55);
    const Lathe lid({.2f, .27f, .36f}, {w * .6f, w * .5f, .08f}, {0, .4f});
    return {{{"",
              [=](const Vec3& p) {
                  return smooth_merge(
                      .04f, {ellipsoid(p, {0, -.1f, 0}, {w, w * .85f, w}),
                             capsule(p, {w * .8f, -.15f, 0}, {w + .32f, .25f, 0}, .12f, .06f)});
              }},
             {"lid",
              [=](const Vec3& p) {
                  return merge({sphere(p, {0, w * .85f + .02f, 0}, .08f), lid.distance(p)});
              }},
             {"handle",
              [=](const Vec3& p) {
                  return std::max(torus(p, {-w - .02f, -.05f, 0}, .24f, .05f, 2), p.x + w * .7f);
              }}},
            .04f};
}

Shape pitcher(Draw& u) {
    const float belly = u(.42, .55), neck = u(.22, .3), lip = u(.3, .38), ring = u(.32, .4);
    const Lathe body({-.8f, -.75f, -.25f, .4f, .8f}, {belly * .7f, belly * .8f, belly, neck, lip},
                     {.06f, .6f});
    return {{{"",
              [=](const Vec3& p) {
                  const float beak =
                      std::max(ellipsoid(p, {lip * .8f, .78f, 0}, {.3f, .16f, .14f}),
                               -ellipsoid(p, {lip * .7f, .86f, 0}, {.28f, .16f, .1f}));
                  return smooth_merge(.03f, {body.distance(p), std::max(beak, p.y - .8f)});
              }},
             {"handle", [=](const Vec3& p) {
                  const Vec3 q((p.x + neck) * 1.15f, (p.y - .2f) * .8f, p.z);
                  return std::max(torus(q, {0, 0, 0}, ring, .055f, 2), p.x + neck * .9f);
              }}}};
}

Shape goblet(Draw& u) {
    const float cup = u(.4, .52), waist = u(.05, .08), foot = u(.32, .44), y = u(-.05, .1);
    const Lathe bowl({y, y + .12f, y + .45f, .9f}, {.06f, cup * .6f, cup, cup * u(.85, 1.05)},
                     {.05f, .5f});
    const Lathe stem({-.85f, -.78f, -.6f, -.3f, y + .06f}, {foot, foot * .9f, waist, waist, waist},
                     {0, .4f});
    return {{{"", turned(bowl)}, {"stem", turned(stem)}}, .03f};
}

Shape bucket(Draw& u) {
    const float top = u(.5, .62), bottom = top * u(.68, .8), h = u(.45, .6), tilt = u(.15, .9);
    const Lathe body({-h, 0, h}, {bottom, (bottom + top) / 2, top}, {.05f, .8f});
    const float c = std::cos(tilt), s = std::sin(tilt);
    return {{{"",
              [=](const Vec3& p) {
                  return merge({body.distance(p), torus(p, {0, h, 0}, top - .02f, .04f)});
              }},
             {"handle", [=](const Vec3& p) {
                  // The handle is an arc over the rim, tilted to one side.
                  const Vec3 q(p.x, (p.y - h) * c + p.z * s, p.z * c - (p.y - h) * s);
                  return std::max(torus(q, {0, 0, 0}, top, .035f, 2), -q.y);
              }}}};
}

Shape barrel(Draw& u) {
    const float end = u(.42, .5), belly = end * u(1.2, 1.35), h = u(.65, .8);
    const Lathe body({-h, 0, h}, {end, belly, end}, {0, .8f});
    return {{{"",
              [=](const Vec3& p) {
                  return std::max(body.distance(p), end * .85f > std::hypot(p.x, p.z)
                                                        ? std::abs(p.y) - h + .06f
                                                        : std::abs(p.y) - h);
              }},
             {"hoops", [=](const Vec3& p) {
                  const float y = std::abs(std::abs(p.y) - h * .55f) - .065f;
                  return std::max((body.distance(p) - .03f), y);
              }}}};
}

Shape pan(Draw& u) {
    const float r = u(.5, .6), h = u(.08, .18), length = u(.6, .8);
    const Lathe body({-h, h}, {r * .88f, r}, {.06f, .8f});
    return {{{"", [=](const Vec3& p) { return body.distance(p + Vec3(.35f, 0, 0)); }},
             {"handle", [=](const Vec3& p) {
                  return capsule(p, {r - .35f, h * .6f, 0}, {r - .35f + length, h + .12f, 0}, .055f,
                                 .075f);
              }}}};
}

Shape basket(Draw& u) {
    const float top = u(.6, .72), h = u(.25, .35);
    const Lathe body({-h, 0, h}, {top * .75f, top * .92f, top}, {.06f, .8f});
    return {{{"",
              [=](const Vec3& p) {
                  return merge({body.distance(p + Vec3(0, .3f, 0)),
                                torus(p, {0, h - .3f, 0}, top - .02f, .055f)});
              }},
             {"handle", [=](const Vec3& p) {
                  const Vec3 q(p.x, (p.y - h + .3f) * .85f, p.z);
                  return std::max(torus(q, {0, 0, 0}, top - .02f, .05f, 2), -q.y);
              }}}};
}

Shape candle(Draw& u) {
    const float r = u(.24, .34), h = u(.35, .6), foot = u(.45, .6);
    return {{{"",
              [=](const Vec3& p) {
                  return cylinder(p, {0, -.7f + h, 0}, r, h, .05f);
              }},
             {"flame",
              [=](const Vec3& p) {
                  const float y = -.7f + 2 * h;
                  return smooth_merge(.08f,
                                      {capsule(p, {0, y, 0}, {0, y + .1f, 0}, .02f),
                                       sphere(p, {0, y + .18f, 0}, .1f),
                                       capsule(p, {0, y + .2f, 0}, {0, y + .42f, 0}, .08f, .01f)});
              }},
             {"dish", [=](const Vec3& p) {
                  return merge({cylinder(p, {0, -.72f, 0}, foot, .05f),
                                torus(p, {0, -.68f, 0}, foot - .03f, .05f)});
              }}}};
}

}  // namespace

std::vector<ShapeMaker> vessel_shapes() {
    return {{{"mug", {"mug", "cup"}}, mug},
            {{"vase", {"vase", "urn"}}, vase},
            {{"bowl", {"bowl"}}, bowl},
            {{"bottle", {"bottle"}}, bottle},
            {{"teapot", {"teapot"}, true}, teapot},
            {{"pitcher", {"pitcher", "jug"}}, pitcher},
            {{"goblet", {"goblet"}}, goblet},
            {{"bucket", {"bucket", "pail"}}, bucket},
            {{"barrel", {"barrel"}}, barrel},
            {{"pan", {"pan"}}, pan},
            {{"basket", {"basket"}}, basket},
            {{"candle", {"candle"}}, candle}};
}

}  // namespace item3d
