#include "item3d/prior/data/shapes/furniture.h"

namespace item3d {
namespace {

using namespace sdf;

Shape chair(Draw& u) {
    const float w = u(.36, .46), seat = u(-.15, 0), leg = u(.045, .07), top = u(.75, .9);
    const float thick = u(.045, .07);
    const bool round_legs = u.pick(2) == 1;
    const int slats = u.pick(3);
    const auto frame = [=](const Vec3& p) {
        const Vec3 q = fold(p, true, true);
        const float legs =
            round_legs ? capsule(q, {w - .07f, seat, w - .07f}, {w - .04f, -.85f, w - .04f}, leg)
                       : box(q, {w - .07f, (seat - .85f) / 2, w - .07f},
                             {leg, (seat + .85f) / 2, leg}, .01f);
        const float middle = (seat + top) / 2, half = (top - seat) / 2;
        float back = box(p, {0, middle, -w + thick}, {w, half, thick}, .03f);
        if (slats > 0) {
            const Vec3 slat = slats == 1 ? Vec3(w, .07f, 9) : Vec3(.1f, half, 9);
            back = std::max(merge({box(q, {w - .06f, middle, 0}, {.05f, half, 9}, .01f),
                                   box(p, {0, top - .12f, 0}, {w, .12f, 9}, .02f),
                                   box(p, {0, middle, 0}, slat, .02f)}),
                            std::abs(p.z + w - thick) - thick);
        }
        return merge({legs, back});
    };
    return {{{"", frame}, {"seat", [=](const Vec3& p) {
                               return box(p, {0, seat, 0}, {w, .06f, w}, .03f);
                           }}}};
}

Shape table(Draw& u) {
    const float w = u(.6, .8), depth = u(.4, .6), h = u(.3, .5), leg = u(.05, .09);
    const float top = u(.045, .07);
    if (u.pick(2) == 1) {
        return {{{"",
                  [=](const Vec3& p) {
                      return merge({cylinder(p, {0, 0, 0}, leg * 1.3f, h),
                                    cylinder(p, {0, -h, 0}, w * .5f, .05f)});
                  }},
                 {"top", [=](const Vec3& p) {
                      return cylinder(p, {0, h, 0}, w, top);
                  }}}};
    }
    return {{{"",
              [=](const Vec3& p) {
                  const Vec3 q = fold(p, true, true);
                  return box(q, {w - .1f, -.1f, depth - .1f}, {leg, h + .1f, leg}, .01f);
              }},
             {"top", [=](const Vec3& p) {
                  return box(p, {0, h, 0}, {w, top, depth}, .02f);
              }}}};
}

Shape lamp(Draw& u) {
    const float bottom = u(.4, .6), top = u(.18, .35), y = u(.05, .2), foot = u(.3, .42);
    const float knob = u(.05, .16);
    const Lathe base({-.85f, -.78f, -.5f, -.2f}, {foot, foot, knob, knob}, {0, .4f});
    return {{{"",
              [=](const Vec3& p) {
                  return merge({cylinder(p, {0, -.35f, 0}, .05f, .5f), base.distance(p)});
              }},
             {"shade", [=](const Vec3& p) { return cone(p, y, .8f, bottom, top); }}}};
}

Shape stool(Draw& u) {
    const float r = u(.38, .5), h = u(.5, .75), spread = u(.02, .14), leg = u(.045, .065);
    const bool three = u.pick(3) == 0;
    const auto legs = [=](const Vec3& p) {
        const float at = r * .68f, low = at + spread;
        float d = 1e9f;
        for (int i = 0; i < (three ? 3 : 4); ++i) {
            const float angle = 2 * pi * static_cast<float>(i) / (three ? 3 : 4) + .785f;
            const Vec3 side(std::cos(angle), 0, std::sin(angle));
            d = std::min(d, capsule(p, side * at + Vec3(0, h, 0), side * low - Vec3(0, h, 0), leg));
        }
        return std::min(d, torus(p, {0, -h * .35f, 0}, at + spread * .7f, .035f));
    };
    return {{{"", legs}, {"seat", [=](const Vec3& p) {
                              return cylinder(p, {0, h, 0}, r, .075f, .04f);
                          }}}};
}

Shape sofa(Draw& u) {
    const float w = u(.75, .95), depth = u(.34, .42), arm = u(.09, .16), back = u(.3, .45);
    const int seats = 2 + u.pick(2);
    return {
        {{"",
          [=](const Vec3& p) {
              const Vec3 q = fold(p, true, true);
              return merge(
                  {box(p, {0, -.25f, 0}, {w, .12f, depth}, .04f),
                   box(p, {0, back * .5f - .2f, -depth + .08f}, {w, back * .5f + .2f, .11f}, .06f),
                   box(fold(p, true, false), {w - arm, -.12f, 0}, {arm, .24f, depth}, .07f),
                   box(q, {w - .1f, -.42f, depth - .1f}, {.045f, .09f, .045f})});
          }},
         {"cushions", [=](const Vec3& p) {
              const float inner = w - 2 * arm, wide = inner / static_cast<float>(seats);
              float d = 1e9f;
              for (int i = 0; i < seats; ++i) {
                  const float x = -inner + wide * (2 * static_cast<float>(i) + 1);
                  d = std::min(d,
                               box(p, {x, -.06f, .07f}, {wide - .015f, .085f, depth - .12f}, .05f));
              }
              return d;
          }}}};
}

Shape bed(Draw& u) {
    const float w = u(.45, .62), length = u(.75, .9), head = u(.25, .45), foot = u(-.05, .12);
    const auto frame = [=](const Vec3& p) {
        const Vec3 q = fold(p, true, true);
        return merge({box(p, {0, -.28f, 0}, {w, .07f, length}, .02f),
                      box(p, {0, (head - .45f) / 2, -length}, {w, (head + .45f) / 2, .05f}, .03f),
                      box(p, {0, (foot - .45f) / 2, length}, {w, (foot + .45f) / 2, .05f}, .03f),
                      box(q, {w - .06f, -.42f, length - .04f}, {.05f, .14f, .05f})});
    };
    return {{{"", frame},
             {"blanket",
              [=](const Vec3& p) {
                  return box(p, {0, -.13f, .12f}, {w - .01f, .1f, length - .2f}, .06f);
              }},
             {"pillow", [=](const Vec3& p) {
                  return ellipsoid(p, {0, -.03f, -length + .24f}, {w * .75f, .1f, .17f});
              }}}};
}

Shape bench(Draw& u) {
    const float w = u(.75, .9), h = u(-.1, .05), back = u(.3, .45), depth = u(.24, .32);
    const int slats = 2 + u.pick(2);
    const auto iron = [=](const Vec3& p) {
        const Vec3 q = fold(p, true, false);
        return merge({box(fold(p, true, true), {w - .14f, (h - .6f) / 2, depth - .05f},
                          {.05f, (h + .6f) / 2, .045f}),
                      box(q, {w - .14f, h + back * .5f, -depth - .02f}, {.05f, back * .5f, .035f}),
                      box(q, {w - .14f, h - .05f, 0}, {.05f, .035f, depth})});
    };
    const auto planks = [=](const Vec3& p) {
        float d = 1e9f;
        for (int i = 0; i < slats; ++i) {
            const float part = (static_cast<float>(i) + .5f) / static_cast<float>(slats);
            const float half = .82f / static_cast<float>(slats);
            d = merge({d, box(p, {0, h, depth * (2 * part - 1)}, {w, .04f, depth * half}, .015f),
                       box(p, {0, h + .12f + back * part * .9f, -depth + .03f},
                           {w, back * half * .45f, .035f}, .015f)});
        }
        return d;
    };
    return {{{"", planks}, {"legs", iron}}};
}

Shape bookcase(Draw& u) {
    const float w = u(.45, .6), h = u(.75, .9), depth = u(.2, .28);
    const int shelves = 2 + u.pick(2);
    const std::uint64_t seed = static_cast<std::uint64_t>(u.pick(10000));
    const float step = (2 * h - .1f) / static_cast<float>(shelves);
    const auto frame = [=](const Vec3& p) {
        float d = std::max(box(p, {0, 0, 0}, {w, h, depth}, .01f),
                           -box(p, {0, 0, .12f}, {w - .06f, h - .06f, depth + .06f}));
        for (int i = 1; i < shelves; ++i)
            d = std::min(d, box(p, {0, -h + .05f + step * static_cast<float>(i), 0},
                                {w - .02f, .03f, depth - .01f}));
        return d;
    };
    const auto books = [=](const Vec3& p) {
        float d = 1e9f;
        for (int i = 0; i < shelves; ++i) {
            Random random(seed, static_cast<std::uint64_t>(i));
            const float floor = -h + .08f + step * static_cast<float>(i);
            for (float x = -w + .09f; x < w - .16f;) {
                const auto thick = static_cast<float>(random.uniform(.035, .06));
                const float tall = (step - .1f) * static_cast<float>(random.uniform(.3, .44));
                if (random.chance(.85))
                    d = std::min(
                        d, box(p, {x + thick, floor + tall, .02f}, {thick, tall, depth - .06f}));
                x += 2 * thick + .008f;
            }
        }
        return d;
    };
    return {{{"", frame}, {"books", books}}};
}

}  // namespace

std::vector<ShapeMaker> furniture_shapes() {
    return {{{"chair", {"chair"}}, chair},
            {{"table", {"table", "desk"}}, table},
            {{"lamp", {"lamp"}}, lamp},
            {{"stool", {"stool"}}, stool},
            {{"sofa", {"sofa", "couch"}, true}, sofa},
            {{"bed", {"bed"}}, bed},
            {{"bench", {"bench"}}, bench},
            {{"bookcase", {"bookcase", "shelf"}}, bookcase}};
}

}  // namespace item3d
