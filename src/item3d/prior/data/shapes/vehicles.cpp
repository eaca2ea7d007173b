#include "item3d/prior/data/shapes/vehicles.h"

namespace item3d {
namespace {

using namespace sdf;

/// Returns the distance to wheels: discs with the axis z on both sides. x: positions of the wheels
/// along the vehicle.
float wheels_at(const Vec3& p, std::initializer_list<float> x, float y, float side, float radius,
                float half_width) {
    float d = 1e9f;
    for (const float at : x)
        d = std::min(d, cylinder({p.x - at, std::abs(p.z) - side, p.y - y}, Vec3(0.0f), radius,
                                 half_width, .03f));
    return d;
}

Shape car(Draw& u) {
    const float l = u(.8, .92), w = u(.34, .4), h = u(.14, .19), cabin = u(.4, .52);
    const float wheel = u(.17, .21), x = u(-.12, .02), roof = u(.17, .22);
    const float lean = u(.15, .4);
    return {{{"",
              [=](const Vec3& p) {
                  const float body = box(p, {0, -.05f, 0}, {l, h, w}, .1f);
                  return std::max(body,
                                  -wheels_at(p, {-l * .6f, l * .6f}, -.2f, w, wheel + .03f, .14f));
              }},
             {"roof",
              [=](const Vec3& p) {
                  // The cabin narrows above the doors.
                  const float y = p.y - .1f, narrow = 1 + lean * std::max(y, 0.0f);
                  const Vec3 q((p.x - x) * narrow, p.y, p.z * narrow);
                  return box(q, {0, .1f + roof * .5f, 0}, {cabin, roof, w * .85f}, .1f) * .75f;
              }},
             {"wheels", [=](const Vec3& p) {
                  return wheels_at(p, {-l * .6f, l * .6f}, -.2f, w - .03f, wheel, .07f);
              }}}};
}

Shape truck(Draw& u) {
    const float l = u(.88, .98), w = u(.32, .38), bed = u(.12, .28), wheel = u(.17, .2);
    const float cab = u(.26, .32), tall = u(.3, .38);
    const bool closed = u.pick(2) == 1;
    const float load = closed ? tall + .12f : bed;
    return {
        {{"",
          [=](const Vec3& p) {
              return merge(
                  {box(p, {0, -.24f, 0}, {l, .07f, w * .8f}, .02f),
                   box(p, {l - cab, tall * .5f - .2f, 0}, {cab, tall * .5f + .12f, w}, .07f)});
          }},
         {"cargo",
          [=](const Vec3& p) {
              const float half = l - cab - .05f, x = -l + half;
              const float whole_box = box(p, {x, load - .2f, 0}, {half, load, w}, .02f);
              if (closed) return whole_box;
              return std::max(whole_box,
                              -box(p, {x, load - .06f, 0}, {half - .05f, load, w - .05f}));
          }},
         {"wheels", [=](const Vec3& p) {
              return wheels_at(p, {-l * .62f, -l * .18f, l * .66f}, -.32f, w - .05f, wheel, .07f);
          }}}};
}

Shape bus(Draw& u) {
    const float l = u(.85, .95), h = u(.28, .36), w = u(.26, .32), wheel = u(.13, .16);
    const int windows = 4 + u.pick(3);
    return {{{"",
              [=](const Vec3& p) {
                  return box(p, {0, .05f, 0}, {l, h, w}, .08f);
              }},
             {"windows",
              [=](const Vec3& p) {
                  const float pitch = 1.7f * l / static_cast<float>(windows);
                  const float i = std::clamp(
                      std::round(p.x / pitch + .5f * static_cast<float>(windows % 2 + 1)), -2.0f,
                      3.0f);
                  const float x = (i - .5f * static_cast<float>(windows % 2 + 1)) * pitch;
                  return merge({box(fold(p, false, true), {x, .05f + h * .35f, w},
                                    {pitch * .38f, h * .34f, .02f}),
                                box(p, {l, .05f + h * .3f, 0}, {.02f, h * .4f, w * .8f})});
              }},
             {"wheels", [=](const Vec3& p) {
                  return wheels_at(p, {-l * .62f, l * .6f}, .05f - h, w - .04f, wheel, .07f);
              }}}};
}

Shape locomotive(Draw& u) {
    const float l = u(.8, .9), r = u(.2, .25), wheel = u(.13, .17), cab = u(.2, .26);
    const float chimney = u(.25, .4), flare = u(.06, .12);
    return {{{"",
              [=](const Vec3& p) {
                  return merge(
                      {cylinder({p.y - .02f, p.x - .15f, p.z}, Vec3(0.0f), r, l * .75f, .04f),
                       box(p, {-l + cab, .12f, 0}, {cab, .34f, .3f}, .02f),
                       box(p, {-l + cab, .48f, 0}, {cab + .07f, .035f, .36f}, .02f),
                       box(p, {0, -.25f, 0}, {l, .06f, .26f}, .02f),
                       sphere(p, {.1f, .02f + r, 0}, .1f)});
              }},
             {"chimney",
              [=](const Vec3& p) {
                  return cone(p - Vec3(l * .72f, 0, 0), .1f, .1f + r + chimney, .07f, .07f + flare);
              }},
             {"wheels", [=](const Vec3& p) {
                  return wheels_at(p, {-l * .7f, -l * .22f, l * .22f, l * .66f}, -.32f, .25f, wheel,
                                   .05f);
              }}}};
}

Shape airplane(Draw& u) {
    const float l = u(.85, .95), r = u(.12, .16), span = u(.8, .95), chord = u(.16, .22);
    const float sweep = u(0, .35), fin = u(.28, .38);
    const auto wings = [=](const Vec3& p) {
        const Vec3 q = fold(p, false, true);
        const float main = box({q.x + q.z * sweep - .1f, q.y + .02f, q.z}, {0, 0, span * .5f},
                               {chord * (1 - .3f * q.z / span), .035f, span * .5f}, .03f);
        const float tail = box({q.x + q.z * sweep + l * .82f, q.y - .06f, q.z}, {0, 0, .16f},
                               {chord * .5f, .03f, .18f}, .02f);
        return merge({main, tail}) * .85f;
    };
    return {{{"",
              [=](const Vec3& p) {
                  const float body = ellipsoid(p, {0, 0, 0}, {l, r, r});
                  const float upright = box({p.x + l * .82f + (p.y - .1f) * .5f, p.y, p.z},
                                            {0, fin * .5f, 0}, {.12f, fin * .5f, .03f}, .02f);
                  return smooth_merge(.03f,
                                      {body, upright * .85f,
                                       ellipsoid(p, {l * .45f, r * .6f, 0}, {.2f, .1f, .08f})});
              }},
             {"wings", wings}}};
}

Shape boat(Draw& u) {
    const float l = u(.7, .85), w = u(.24, .32), h = u(.18, .24), mast = u(.75, .9);
    const auto hull = [=](const Vec3& p) {
        const float narrow = std::sqrt(std::max(.05f, 1 - std::pow(std::abs(p.x) / l, 2.2f)));
        const Vec3 q(p.x * .98f, p.y + .45f, p.z / std::max(narrow, .3f));
        const float shell = std::max(ellipsoid(q, {0, .12f, 0}, {l, h * 1.5f, w}), q.y - .12f);
        const float hollow = ellipsoid(q, {0, .2f, 0}, {l * .85f, h, w * .78f});
        return std::max(shell, -hollow) * .5f;
    };
    return {{{"",
              [=](const Vec3& p) {
                  return merge({hull(p), capsule(p, {.05f, -.6f, 0}, {.05f, mast, 0}, .035f)});
              }},
             {"sail", [=](const Vec3& p) {
                  // The sails are a triangle behind the mast and a smaller triangle before it.
                  const float y = p.y + .2f, tall = mast + .14f;
                  const float side =
                      p.x < .05f ? (.0f - p.x) / (l * .85f) : (p.x - .1f) / (l * .5f);
                  const float edge = (side + y / tall - 1) * .45f;
                  const float slab = std::abs(p.z) - .025f;
                  const float gap = .03f - std::abs(p.x - .05f);
                  return std::max(std::max(edge, slab), std::max(-y, gap));
              }}}};
}

Shape rocket(Draw& u) {
    const float r = u(.2, .27), h = u(.45, .6), nose = u(.35, .45), fin = u(.22, .32);
    const int fins = 3 + u.pick(2);
    const Lathe body({-h - .1f, -h, 0, h}, {r * .6f, r * .85f, r, r * .8f}, {0, .8f});
    return {{{"", turned(body)},
             {"nose",
              [=](const Vec3& p) {
                  return std::max(ellipsoid(p, {0, h - .02f, 0}, {r * .81f, nose, r * .81f}),
                                  h - .02f - p.y);
              }},
             {"fins", [=](const Vec3& p) {
                  float d = 1e9f;
                  for (int i = 0; i < fins; ++i) {
                      const float angle = 2 * pi * static_cast<float>(i) / static_cast<float>(fins);
                      const float c = std::cos(angle), s = std::sin(angle);
                      const Vec3 q(p.x * c + p.z * s, p.y, p.z * c - p.x * s);
                      const Vec3 sheared(q.x, q.y + q.x * .7f, q.z);
                      d = std::min(d, box(sheared, {r + fin * .4f, -h + .28f, 0},
                                          {fin * .6f, .2f, .035f}, .02f) *
                                          .75f);
                  }
                  return d;
              }}}};
}

}  // namespace

std::vector<ShapeMaker> vehicle_shapes() {
    return {{{"car", {"car", "automobile"}}, car},
            {{"truck", {"truck", "lorry"}}, truck},
            {{"bus", {"bus"}}, bus},
            {{"locomotive", {"locomotive", "train"}}, locomotive},
            {{"airplane", {"airplane", "plane"}}, airplane},
            {{"boat", {"boat", "sailboat"}, true}, boat},
            {{"rocket", {"rocket"}}, rocket}};
}

}  // namespace item3d
