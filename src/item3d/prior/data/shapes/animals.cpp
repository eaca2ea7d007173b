#include "item3d/prior/data/shapes/animals.h"

namespace item3d {
namespace {

using namespace sdf;

struct Limbs {
    float front, back;  ///< x of the legs
    float hip, side;    ///< height of their upper ends, distance from the middle
    float foot, radius;
};

/// Returns the distance to two legs of one side. The caller mirrors z, so the animal has four legs.
float four_legs(const Vec3& q, const Limbs& at) {
    return std::min(
        capsule(q, {at.front, at.hip, at.side}, {at.front, at.foot, at.side * 1.1f}, at.radius),
        capsule(q, {at.back, at.hip, at.side}, {at.back, at.foot, at.side * 1.1f}, at.radius));
}

Shape fish(Draw& u) {
    const float l = u(.6, .72), h = u(.3, .42), w = u(.15, .25), tail = u(.25, .4);
    return {{{"",
              [=](const Vec3& p) {
                  return ellipsoid(p, {.1f, 0, 0}, {l, h, w});
              }},
             {"fins",
              [=](const Vec3& p) {
                  return smooth_merge(
                      .08f, {ellipsoid(p, {-l - .08f, 0, 0}, {.22f, tail, .05f}),
                             ellipsoid(p, {0, h, 0}, {.28f, .16f, .045f}),
                             ellipsoid(fold(p, false, true), {.15f, -.1f, w}, {.15f, .06f, .12f})});
              }}},
            .08f};
}

Shape duck(Draw& u) {
    const float l = u(.52, .62), h = u(.34, .42), head = u(.25, .31);
    return {{{"",
              [=](const Vec3& p) {
                  return smooth_merge(.12f, {ellipsoid(p, {-.05f, -.3f, 0}, {l, h, h * 1.05f}),
                                             sphere(p, {.3f, .3f, 0}, head),
                                             ellipsoid(p, {-l, -.08f, 0}, {.22f, .14f, .16f})});
              }},
             {"beak", [=](const Vec3& p) {
                  return ellipsoid(p, {.3f + head + .08f, .25f, 0}, {.18f, .05f, .11f});
              }}}};
}

Shape cow(Draw& u) {
    const float l = u(.48, .58), h = u(.26, .33), leg = u(.07, .1), muzzle = u(.17, .22);
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, false, true);
                  const float legs = merge(
                      {capsule(q, {l * .7f, -.1f, h * .55f}, {l * .75f, -.68f, h * .6f}, leg),
                       capsule(q, {-l * .7f, -.1f, h * .55f}, {-l * .75f, -.68f, h * .6f}, leg)});
                  const float head = smooth_merge(
                      .1f, {ellipsoid(p, {l + .2f, .33f, 0}, {muzzle * 1.2f, muzzle, muzzle * .9f}),
                            sphere(p, {l + .38f, .27f, 0}, muzzle * .6f)});
                  return smooth_merge(
                      .08f, {ellipsoid(p, {0, .05f, 0}, {l * 1.25f, h, h * .95f}), legs, head,
                             capsule(p, {l * .9f, .15f, 0}, {l + .15f, .3f, 0}, muzzle * .7f),
                             ellipsoid(q, {l + .12f, .47f, muzzle * .95f}, {.04f, .06f, .14f}),
                             capsule(p, {-l * 1.2f, .15f, 0}, {-l * 1.35f, -.25f, 0}, .035f)});
              }},
             {"horns", [=](const Vec3& p) {
                  return capsule(fold(p, false, true), {l + .14f, .48f, .09f},
                                 {l + .12f, .7f, .19f}, .05f, .025f);
              }}}};
}

Shape dog(Draw& u) {
    const float l = u(.42, .52), r = u(.19, .24), head = u(.2, .25), tail = u(.1, .45);
    const float snout = u(.14, .24), y = u(.32, .42);
    return {
        {{"",
          [=](const Vec3& p) {
              const Vec3 q = fold(p, false, true);
              return smooth_merge(
                  .07f,
                  {capsule(p, {-l, -.02f, 0}, {l, .03f, 0}, r, r * 1.15f),
                   four_legs(q, {l, -l, -.1f, .13f, -.68f, .075f}),
                   capsule(p, {l, .1f, 0}, {l + .15f, y, 0}, r * .7f),
                   sphere(p, {l + .2f, y + .05f, 0}, head),
                   capsule(p, {l + .25f, y - .02f, 0}, {l + .3f + snout, y - .06f, 0}, .12f, .085f),
                   capsule(p, {-l - .1f, .05f, 0}, {-l - .3f, .05f + tail, 0}, .06f, .035f)});
          }},
         {"ears",
          [=](const Vec3& p) {
              return ellipsoid(fold(p, false, true), {l + .12f, y + .06f, head + .01f},
                               {.1f, .2f, .06f});
          }},
         {"collar", [=](const Vec3& p) {
              // The collar is perpendicular to the neck, which leans forward.
              const Vec3 q(p.x - l - .07f, p.y - y * .62f, p.z);
              const Vec3 t(q.x * .9f - q.y * .43f, q.y * .9f + q.x * .43f, q.z);
              return torus(t, {0, 0, 0}, r * .75f, .05f);
          }}}};
}

Shape cat(Draw& u) {
    // The cat sits, with its tail around its body.
    const float w = u(.27, .33), head = u(.24, .29), y = u(.35, .45), tail = u(.2, .5);
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, false, true);
                  const float body = smooth_merge(
                      .15f, {ellipsoid(p, {-.12f, -.38f, 0}, {.4f, .34f, w}),
                             capsule(p, {0, -.2f, 0}, {.12f, y - .1f, 0}, w * .8f, w * .55f),
                             capsule(q, {.18f, -.1f, .11f}, {.24f, -.66f, .12f}, .08f),
                             ellipsoid(q, {-.1f, -.55f, w * .85f}, {.28f, .16f, .12f})});
                  const float face = smooth_merge(
                      .06f, {ellipsoid(p, {.18f, y + .12f, 0}, {head, head * .88f, head * 1.05f}),
                             sphere(p, {.18f + head * .85f, y + .05f, 0}, .09f)});
                  return smooth_merge(.05f, {body, face});
              }},
             {"ears",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, false, true);
                  return cone({q.x - .15f, q.y - .02f * q.z, (q.z - head * .62f) * .9f},
                              y + .12f + head * .55f, y + .16f + head * 1.35f, .12f, .01f) *
                         .8f;
              }},
             {"tail",
              [=](const Vec3& p) {
                  return smooth_merge(
                      .05f,
                      {capsule(p, {-.42f, -.6f, 0}, {-.75f, -.55f, .1f}, .07f),
                       capsule(p, {-.75f, -.55f, .1f}, {-.85f, -.55f + tail, .12f}, .07f, .055f)});
              }}},
            .03f};
}

Shape rabbit(Draw& u) {
    const float w = u(.3, .36), ear = u(.4, .58), lean = u(-.1, .12), head = u(.22, .26);
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, false, true);
                  return smooth_merge(
                      .1f, {ellipsoid(p, {-.1f, -.35f, 0}, {.42f, .36f, w}),
                            ellipsoid(q, {-.12f, -.55f, w * .8f}, {.26f, .18f, .12f}),
                            capsule(q, {.2f, -.3f, .12f}, {.28f, -.66f, .12f}, .08f),
                            ellipsoid(p, {.3f, .12f, 0}, {head * 1.1f, head, head * .9f})});
              }},
             {"ears",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, false, true);
                  return ellipsoid({q.x - lean * (q.y - .25f), q.y, q.z},
                                   {.22f, .25f + ear * .6f, .11f}, {.05f, ear * .6f, .085f});
              }},
             {"tail",
              [=](const Vec3& p) {
                  return sphere(p, {-.53f, -.42f, 0}, .12f);
              }}},
            .03f};
}

Shape penguin(Draw& u) {
    const float w = u(.36, .44), h = u(.6, .7), head = u(.24, .29);
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, false, true);
                  return smooth_merge(
                      .1f, {ellipsoid(p, {0, -.2f, 0}, {w, h, w}), sphere(p, {.04f, .5f, 0}, head),
                            ellipsoid({q.x, q.y, q.z - w - .02f + .25f * (q.y + .15f)},
                                      {0, -.15f, 0}, {.14f, .36f, .05f})});
              }},
             {"belly",
              [=](const Vec3& p) {
                  return ellipsoid(p, {.1f, -.24f, 0}, {w * .82f, h * .8f, w * .72f});
              }},
             {"beak", [=](const Vec3& p) {
                  const Vec3 q = fold(p, false, true);
                  return merge({capsule(p, {.2f, .48f, 0}, {.2f + head, .45f, 0}, .085f, .02f),
                                ellipsoid(q, {.16f, -.8f, .16f}, {.22f, .06f, .13f})});
              }}}};
}

Shape elephant(Draw& u) {
    const float l = u(.36, .44), r = u(.3, .36), leg = u(.11, .14), ear = u(.24, .32);
    const float lift = u(-.15, .35);
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, false, true);
                  const Vec3 face(l + .28f, .22f, 0), bend(l + .6f, -.18f, 0);
                  return smooth_merge(
                      .1f,
                      {ellipsoid(p, {0, .02f, 0}, {l * 1.3f, r, r * .9f}),
                       four_legs(q, {l * .8f, -l * .8f, -.1f, r * .5f, -.66f, leg}),
                       sphere(p, face, .24f), capsule(p, {l + .45f, .15f, 0}, bend, .11f, .085f),
                       capsule(p, bend, {l + .72f, -.32f + lift, 0}, .085f, .06f),
                       capsule(p, {-l * 1.25f, .1f, 0}, {-l * 1.45f, -.2f, 0}, .035f)});
              }},
             {"ears",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, false, true);
                  return ellipsoid({q.x + (q.z - .25f) * .5f, q.y, q.z},
                                   {l + .16f, .2f, .2f + ear * .6f}, {.06f, ear, ear * .85f});
              }},
             {"tusks", [=](const Vec3& p) {
                  return capsule(fold(p, false, true), {l + .42f, .06f, .12f},
                                 {l + .68f, -.02f, .17f}, .045f, .02f);
              }}}};
}

Shape pig(Draw& u) {
    const float l = u(.42, .5), r = u(.32, .38), head = u(.24, .28), leg = u(.09, .12);
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, false, true);
                  return smooth_merge(
                      .06f, {ellipsoid(p, {0, 0, 0}, {l * 1.25f, r, r}),
                             four_legs(q, {l * .65f, -l * .65f, -.15f, .18f, -.5f, leg}),
                             sphere(p, {l + .12f, .12f, 0}, head),
                             ellipsoid({q.x - .5f * q.y, q.y, q.z}, {l - .08f, .38f, .16f},
                                       {.05f, .13f, .1f}),
                             torus(p, {-l * 1.25f - .06f, .12f, 0}, .07f, .03f, 0)});
              }},
             {"snout", [=](const Vec3& p) {
                  return cylinder({p.y - .08f, p.x - l - .12f - head, p.z}, Vec3(0.0f), .12f, .09f,
                                  .03f);
              }}}};
}

Shape turtle(Draw& u) {
    const float l = u(.58, .68), h = u(.36, .48), head = u(.15, .19);
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, true, true);
                  return smooth_merge(
                      .05f, {ellipsoid(p, {0, -.22f, 0}, {l * .95f, .13f, l * .8f}),
                             ellipsoid(q, {l * .62f, -.3f, l * .68f}, {.2f, .12f, .16f}),
                             ellipsoid(p, {l + .2f, -.02f, 0}, {head * 1.15f, head, head}),
                             capsule(p, {l * .7f, -.2f, 0}, {l + .15f, -.05f, 0}, .1f),
                             capsule(p, {-l * .9f, -.25f, 0}, {-l - .18f, -.3f, 0}, .06f, .02f)});
              }},
             {"shell", [=](const Vec3& p) {
                  return std::max(ellipsoid(p, {0, -.2f, 0}, {l, h, l * .86f}), -.2f - p.y);
              }}}};
}

Shape snail(Draw& u) {
    const float r = u(.36, .42), tube = u(.13, .16), feeler = u(.22, .32);
    return {
        {{"",
          [=](const Vec3& p) {
              const Vec3 q = fold(p, false, true);
              return smooth_merge(
                  .08f,
                  {capsule({p.x, p.y, p.z * .75f}, {-.75f, -.6f, 0}, {.55f, -.57f, 0}, .05f, .13f),
                   capsule(p, {.5f, -.55f, 0}, {.68f, -.25f, 0}, .13f, .12f),
                   capsule(q, {.7f, -.2f, .05f}, {.78f, -.2f + feeler, .14f}, .03f, .045f)});
          }},
         {"shell", [=](const Vec3& p) {
              // The shell is a tube along an Archimedean spiral. It is thinner towards the centre.
              const Vec3 q = p - Vec3(-.12f, -.08f, 0);
              const float radius = std::hypot(q.x, q.y), angle = std::atan2(q.y, q.x) / (2 * pi);
              const float pitch = tube * 1.45f;
              const float turn = std::round(radius / pitch - angle);
              const float at = std::clamp((turn + angle) * pitch, .0f, r);
              const float thick = tube * (.55f + .6f * at / r);
              return std::hypot(radius - at, q.z) * .85f - thick * .85f;
          }}}};
}

}  // namespace

std::vector<ShapeMaker> animal_shapes() {
    return {{{"fish", {"fish"}}, fish},
            {{"duck", {"duck"}}, duck},
            {{"cow", {"cow"}}, cow},
            {{"dog", {"dog", "puppy"}}, dog},
            {{"cat", {"cat", "kitten"}}, cat},
            {{"rabbit", {"rabbit", "bunny"}, true}, rabbit},
            {{"penguin", {"penguin"}}, penguin},
            {{"elephant", {"elephant"}}, elephant},
            {{"pig", {"pig"}}, pig},
            {{"turtle", {"turtle", "tortoise"}}, turtle},
            {{"snail", {"snail"}}, snail}};
}

}  // namespace item3d
