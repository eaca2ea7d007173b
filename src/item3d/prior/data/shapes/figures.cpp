#include "item3d/prior/data/shapes/figures.h"

namespace item3d {
namespace {

using namespace sdf;

Shape snowman(Draw& u) {
    const float a = u(.4, .48), b = u(.28, .35), c = u(.2, .26);
    const float y = -.85f + a, y2 = y + a + b * .7f, y3 = y2 + b + c * .6f;
    const bool arms = u.pick(2) == 1, hat = u.pick(2) == 1;
    Shape shape{{{"",
                  [=](const Vec3& p) {
                      const float d =
                          smooth_merge(.05f, {sphere(p, {0, y, 0}, a), sphere(p, {0, y2, 0}, b),
                                              sphere(p, {0, y3, 0}, c)});
                      if (!arms) return d;
                      return merge({d, capsule(fold(p, true, false), {b * .8f, y2, 0},
                                               {b + .35f, y2 + .22f, 0}, .035f)});
                  }},
                 {"nose", [=](const Vec3& p) {
                      return capsule(p, {0, y3, c}, {0, y3, c + .16f}, .045f, .015f);
                  }}}};
    if (hat)
        shape.parts.push_back({"hat", [=](const Vec3& p) {
                                   return merge(
                                       {cylinder(p, {0, y3 + c * .75f, 0}, c * 1.1f, .025f),
                                        cylinder(p, {0, y3 + c * .75f + .1f, 0}, c * .7f, .12f)});
                               }});
    return shape;
}

Shape robot(Draw& u) {
    const float w = u(.3, .4), h = u(.3, .38), head = u(.17, .24), arm = u(.06, .085);
    const float raise = u(-.35, .5);
    const bool round_head = u.pick(3) == 0;
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, true, false);
                  return merge({box(p, {0, -.08f, 0}, {w, h, w * .7f}, .04f),
                                capsule(q, {w + .03f, h * .55f - .08f, 0},
                                        {w + .24f, h * .55f - .3f + raise, .1f}, arm),
                                sphere(q, {w + .24f, h * .55f - .3f + raise, .1f}, arm * 1.6f),
                                box(q, {w * .55f, -h - .3f, 0}, {.1f, .26f, .1f}, .02f),
                                box(q, {w * .55f, -h - .54f, .06f}, {.14f, .06f, .2f}, .03f)});
              }},
             {"head",
              [=](const Vec3& p) {
                  const float y = h + head + .02f;
                  const float skull = round_head
                                          ? sphere(p, {0, y, 0}, head * 1.15f)
                                          : box(p, {0, y, 0}, {head * 1.25f, head, head}, .04f);
                  return merge({skull, cylinder(p, {0, h - .06f, 0}, .09f, .08f),
                                capsule(p, {0, y + head, 0}, {0, y + head + .2f, 0}, .025f),
                                sphere(p, {0, y + head + .22f, 0}, .055f)});
              }},
             {"eyes", [=](const Vec3& p) {
                  const float y = h + head + .06f;
                  return sphere(fold(p, true, false),
                                {head * .5f, y, head * (round_head ? 1.f : .95f)}, .065f);
              }}}};
}

Shape pawn(Draw& u) {
    const float head = u(.24, .3), foot = u(.45, .55), neck = u(.12, .17);
    const Lathe body({-.85f, -.72f, -.66f, -.5f, .1f, .25f},
                     {foot, foot, foot * .78f, foot * .7f, neck, neck}, {0, .5f});
    const float y = .3f + head * .8f;
    return whole([=](const Vec3& p) {
        return merge({body.distance(p), sphere(p, {0, y, 0}, head),
                      ellipsoid(p, {0, .26f, 0}, {head * 1.1f, .06f, head * 1.1f})});
    });
}

Shape teddy(Draw& u) {
    const float belly = u(.33, .4), head = u(.27, .32), limb = u(.11, .14);
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, true, false);
                  return smooth_merge(
                      .05f, {ellipsoid(p, {0, -.3f, 0}, {belly, belly * 1.05f, belly * .9f}),
                             sphere(p, {0, .32f, 0}, head),
                             capsule(q, {belly * .8f, -.1f, .05f}, {belly + .18f, -.3f, .2f}, limb),
                             capsule(q, {belly * .6f, -.55f, .1f}, {belly * .85f, -.6f, .45f},
                                     limb * 1.15f),
                             sphere(q, {head * .75f, .32f + head * .75f, 0}, .13f)});
              }},
             {"snout",
              [=](const Vec3& p) {
                  return ellipsoid(p, {0, .24f, head * .85f}, {.15f, .12f, .13f});
              }},
             {"bow", [=](const Vec3& p) {
                  const Vec3 q = fold(p, true, false);
                  return smooth_merge(.03f, {ellipsoid({q.x, q.y, q.z}, {.14f, .03f, belly * .82f},
                                                       {.14f, .085f, .06f}),
                                             sphere(p, {0, .03f, belly * .85f}, .06f)});
              }}}};
}

Shape gnome(Draw& u) {
    const float w = u(.34, .42), hat = u(.65, .85), tip = u(-.12, .12);
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, true, false);
                  return smooth_merge(.05f,
                                      {cone(p, -.75f, -.05f, w * 1.1f, w * .75f) - .03f,
                                       sphere(p, {0, .1f, 0}, w * .75f),
                                       capsule(q, {w * .75f, -.1f, 0}, {w * .7f, -.38f, .3f}, .1f),
                                       sphere(p, {0, .08f, w * .75f}, .085f)});
              }},
             {"hat",
              [=](const Vec3& p) {
                  const float bend = std::max(p.y - .2f, 0.0f);
                  const Vec3 q(p.x - tip * bend * bend * 2, p.y, p.z + .1f * bend);
                  return cone(q, .2f, .2f + hat, w * .95f, .03f) * .85f - .02f;
              }},
             {"beard", [=](const Vec3& p) {
                  return ellipsoid(p, {0, -.16f, w * .62f}, {w * .62f, .34f, .2f});
              }}}};
}

Shape ghost(Draw& u) {
    const float r = u(.4, .5), flare = u(1.1, 1.35);
    const auto folds = static_cast<float>(4 + u.pick(3));
    return {
        {{"",
          [=](const Vec3& p) {
              const float down = std::clamp((.2f - p.y) / .95f, 0.0f, 1.0f);
              const float angle = std::atan2(p.z, p.x);
              const float radius =
                  r * (1 + (flare - 1) * down) + .06f * down * std::cos(angle * folds);
              const float side =
                  p.y > .2f ? sphere(p, {0, .2f, 0}, r) : std::hypot(p.x, p.z) - radius;
              const float hem = -.78f + .07f * std::cos(angle * folds + 1.5f);
              const Vec3 q = fold(p, true, false);
              return std::max(
                  smooth_merge(.08f, {side * .8f, capsule(q, {r * .8f, -.05f, .1f},
                                                          {r + .2f, .08f, .2f}, .11f, .07f)}),
                  hem - p.y);
          }},
         {"eyes", [=](const Vec3& p) {
              return ellipsoid(fold(p, true, false), {.15f, .28f, r * .93f}, {.075f, .11f, .06f});
          }}}};
}

}  // namespace

std::vector<ShapeMaker> figure_shapes() {
    return {{{"snowman", {"snowman"}}, snowman},
            {{"robot", {"robot"}}, robot},
            {{"pawn", {"pawn"}}, pawn},
            {{"teddy", {"teddy"}}, teddy},
            {{"gnome", {"gnome", "dwarf"}}, gnome},
            {{"ghost", {"ghost"}}, ghost}};
}

}  // namespace item3d
