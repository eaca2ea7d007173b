#include "item3d/prior/shapes.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/prior/lathe.h"

#include <map>

namespace item3d {
namespace {

using namespace sdf;

/// Draws the numbers of a variant.
class Draw {
  public:
    explicit Draw(Random random) : random_(random) {}
    float operator()(double low, double high) {
        return static_cast<float>(random_.uniform(low, high));
    }
    int pick(int count) { return static_cast<int>(random_.index(count)); }

  private:
    Random random_;
};

SignedDistance mug(Draw& u) {
    const float r = u(.45, .6), h = u(.5, .65), wall = u(.06, .09), ring = u(.24, .36);
    const float taper = u(-.08, .1), y = u(-.08, .08), tube = u(.05, .08);
    const Lathe body({-h, 0, h}, {r - taper, r - taper * .4f, r}, {wall, .8f});
    return [=](const Vec3& p) {
        const Vec3 q(p.x, (p.y - y) * .85f, p.z);
        const float handle = std::max(torus(q, {r - taper * .4f + .02f, 0, 0}, ring, tube, 2),
                                      (r - taper) * .9f - std::hypot(p.x, p.z));
        return merge({body.distance(p), handle});
    };
}

SignedDistance vase(Draw& u) {
    const Lathe body({-.85f, -.5f, -.1f, .3f, .6f, .85f},
                     {u(.2, .35), u(.35, .55), u(.35, .6), u(.2, .5), u(.15, .25), u(.22, .4)},
                     {.06f, .6f});
    return [=](const Vec3& p) { return body.distance(p); };
}

SignedDistance bowl(Draw& u) {
    const float radius = u(.7, .85), h = u(.3, .45), base = u(.25, .35);
    const Lathe body({-h, -h + .08f, 0, h}, {base, base * 1.1f, radius * .8f, radius}, {.07f, .5f});
    return [=](const Vec3& p) { return body.distance(p); };
}

SignedDistance bottle(Draw& u) {
    const float b = u(.26, .38), n = u(.09, .14), s = u(.05, .3);
    const Lathe body({-.9f, -.85f, s - .1f, s + .25f, .8f, .82f, .9f},
                     {b * .9f, b, b, n, n, n * 1.25f, n * 1.25f}, {0, .5f});
    return [=](const Vec3& p) { return body.distance(p); };
}

SignedDistance ball(Draw& u) {
    const float r = u(.7, .85);
    return [=](const Vec3& p) { return sphere(p, {0, 0, 0}, r); };
}

SignedDistance cube(Draw& u) {
    const float a = u(.5, .58), b = a * u(.85, 1.1), rounding = u(.01, .12);
    return [=](const Vec3& p) { return box(p, {0, 0, 0}, {a, b, a}, rounding); };
}

SignedDistance donut(Draw& u) {
    const float ring = u(.5, .58), tube = u(.2, .3);
    return [=](const Vec3& p) { return torus(p, {0, 0, 0}, ring, tube); };
}

SignedDistance chair(Draw& u) {
    const float w = u(.36, .46), seat = u(-.15, 0), leg = u(.045, .07), top = u(.75, .9);
    const float thick = u(.045, .07);
    const bool round_legs = u.pick(2) == 1;
    const int slats = u.pick(3);
    return [=](const Vec3& p) {
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
        return merge({box(p, {0, seat, 0}, {w, .06f, w}, .03f), legs, back});
    };
}

SignedDistance table(Draw& u) {
    const float w = u(.6, .8), depth = u(.4, .6), h = u(.3, .5), leg = u(.05, .09);
    const float top = u(.045, .07);
    if (u.pick(2) == 1) {
        return [=](const Vec3& p) {
            return merge({cylinder(p, {0, h, 0}, w, top), cylinder(p, {0, 0, 0}, leg * 1.3f, h),
                          cylinder(p, {0, -h, 0}, w * .5f, .05f)});
        };
    }
    return [=](const Vec3& p) {
        const Vec3 q = fold(p, true, true);
        return merge({box(p, {0, h, 0}, {w, top, depth}, .02f),
                      box(q, {w - .1f, -.1f, depth - .1f}, {leg, h + .1f, leg}, .01f)});
    };
}

SignedDistance lamp(Draw& u) {
    const float bottom = u(.4, .6), top = u(.18, .35), y = u(.05, .2), foot = u(.3, .42);
    const float knob = u(.05, .16);
    const Lathe base({-.85f, -.78f, -.5f, -.2f}, {foot, foot, knob, knob}, {0, .4f});
    return [=](const Vec3& p) {
        return merge({cone(p, y, .8f, bottom, top), cylinder(p, {0, -.35f, 0}, .05f, .5f),
                      base.distance(p)});
    };
}

SignedDistance mushroom(Draw& u) {
    const float radius = u(.6, .8), h = u(.35, .55), stem = u(.16, .27);
    return [=](const Vec3& p) {
        const float cap = std::max(ellipsoid(p, {0, .15f, 0}, {radius, h, radius}), .12f - p.y);
        return smooth_merge(.1f, {cap, cone(p, -.75f, .2f, stem * 1.25f, stem)});
    };
}

SignedDistance apple(Draw& u) {
    const float w = u(.68, .78);
    const Lathe body({-.68f, -.66f, -.3f, .2f, .55f, .62f}, {.15f, .3f, w * .88f, w, w * .6f, .02f},
                     {0, .45f});
    return [=](const Vec3& p) {
        return merge({body.distance(p), capsule(p, {0, .5f, 0}, {.06f, .85f, 0}, .04f)});
    };
}

SignedDistance pear(Draw& u) {
    const float wide = u(.5, .6), narrow = u(.2, .28);
    return [=](const Vec3& p) {
        return merge(
            {smooth_merge(.35f, {sphere(p, {0, -.3f, 0}, wide), sphere(p, {0, .38f, 0}, narrow)}),
             capsule(p, {0, .5f, 0}, {.07f, .85f, 0}, .035f)});
    };
}

SignedDistance snowman(Draw& u) {
    const float a = u(.4, .48), b = u(.28, .35), c = u(.2, .26);
    const float y = -.85f + a, y2 = y + a + b * .7f, y3 = y2 + b + c * .6f;
    const bool arms = u.pick(2) == 1, hat = u.pick(2) == 1;
    return [=](const Vec3& p) {
        float d = smooth_merge(
            .05f, {sphere(p, {0, y, 0}, a), sphere(p, {0, y2, 0}, b), sphere(p, {0, y3, 0}, c)});
        d = merge({d, capsule(p, {0, y3, c}, {0, y3, c + .16f}, .045f, .015f)});
        if (arms) {
            const Vec3 q = fold(p, true, false);
            d = merge({d, capsule(q, {b * .8f, y2, 0}, {b + .35f, y2 + .22f, 0}, .035f)});
        }
        if (hat) {
            d = merge({d, cylinder(p, {0, y3 + c * .75f, 0}, c * 1.1f, .025f),
                       cylinder(p, {0, y3 + c * .75f + .1f, 0}, c * .7f, .12f)});
        }
        return d;
    };
}

SignedDistance house(Draw& u) {
    const float w = u(.5, .65), depth = u(.4, .6), h = u(.25, .42), roof = u(.35, .55);
    const float overhang = u(.03, .1), eaves = -.35f + h;
    const bool chimney = u.pick(2) == 1;
    const float slope = roof / (depth + overhang), scale = 1 / std::hypot(1.0f, slope);
    return [=](const Vec3& p) {
        const float tiles = std::max(
            std::max((p.y - eaves - roof + std::abs(p.z) * slope) * scale, eaves - .02f - p.y),
            std::abs(p.x) - w - overhang);
        float d = merge({box(p, {0, -.35f, 0}, {w, h, depth}, .01f), tiles,
                         box(p, {w * .1f, -.35f - h * .35f, depth}, {.1f, h * .6f, .03f})});
        if (chimney) {
            d = merge(
                {d, box(p, {w * .5f, eaves + roof * .6f, -depth * .4f}, {.08f, roof * .5f, .08f})});
        }
        return d;
    };
}

SignedDistance fish(Draw& u) {
    const float l = u(.6, .72), h = u(.3, .42), w = u(.15, .25), tail = u(.25, .4);
    return [=](const Vec3& p) {
        return smooth_merge(.08f,
                            {ellipsoid(p, {.1f, 0, 0}, {l, h, w}),
                             ellipsoid(p, {-l - .08f, 0, 0}, {.22f, tail, .05f}),
                             ellipsoid(p, {0, h, 0}, {.28f, .16f, .045f}),
                             ellipsoid(fold(p, false, true), {.15f, -.1f, w}, {.15f, .06f, .12f})});
    };
}

SignedDistance duck(Draw& u) {
    const float l = u(.52, .62), h = u(.34, .42), head = u(.25, .31);
    return [=](const Vec3& p) {
        return merge({smooth_merge(.12f, {ellipsoid(p, {-.05f, -.3f, 0}, {l, h, h * 1.05f}),
                                          sphere(p, {.3f, .3f, 0}, head),
                                          ellipsoid(p, {-l, -.08f, 0}, {.22f, .14f, .16f})}),
                      ellipsoid(p, {.3f + head + .08f, .25f, 0}, {.18f, .05f, .11f})});
    };
}

SignedDistance cow(Draw& u) {
    const float l = u(.48, .58), h = u(.26, .33), leg = u(.07, .1), muzzle = u(.17, .22);
    return [=](const Vec3& p) {
        const Vec3 q = fold(p, false, true);
        const float legs =
            merge({capsule(q, {l * .7f, -.1f, h * .55f}, {l * .75f, -.68f, h * .6f}, leg),
                   capsule(q, {-l * .7f, -.1f, h * .55f}, {-l * .75f, -.68f, h * .6f}, leg)});
        const float head = smooth_merge(
            .1f, {ellipsoid(p, {l + .2f, .33f, 0}, {muzzle * 1.2f, muzzle, muzzle * .9f}),
                  sphere(p, {l + .38f, .27f, 0}, muzzle * .6f)});
        return smooth_merge(.08f,
                            {ellipsoid(p, {0, .05f, 0}, {l * 1.25f, h, h * .95f}), legs, head,
                             capsule(p, {l * .9f, .15f, 0}, {l + .15f, .3f, 0}, muzzle * .7f),
                             ellipsoid(q, {l + .12f, .47f, muzzle * .95f}, {.04f, .06f, .14f}),
                             capsule(q, {l + .14f, .5f, .08f}, {l + .14f, .66f, .14f}, .035f),
                             capsule(p, {-l * 1.2f, .15f, 0}, {-l * 1.35f, -.25f, 0}, .035f)});
    };
}

SignedDistance teapot(Draw& u) {
    const float w = u(.48, .55);
    const Lathe lid({.2f, .27f, .36f}, {w * .6f, w * .5f, .08f}, {0, .4f});
    return [=](const Vec3& p) {
        const float handle =
            std::max(torus(p, {-w - .02f, -.05f, 0}, .24f, .05f, 2), p.x + w * .7f);
        return smooth_merge(
            .04f, {ellipsoid(p, {0, -.1f, 0}, {w, w * .85f, w}),
                   merge({sphere(p, {0, w * .85f + .02f, 0}, .08f), lid.distance(p)}),
                   capsule(p, {w * .8f, -.15f, 0}, {w + .32f, .25f, 0}, .12f, .06f), handle});
    };
}

/// Nothing in particular: what makes "object" a word for shapes without a name.
SignedDistance blob(Draw& u) {
    struct Part {
        int kind;
        Vec3 center;
        Vec3 size;
    };
    std::vector<Part> parts(static_cast<std::size_t>(3 + u.pick(5)));
    for (Part& part : parts) {
        part.kind = u.pick(4);
        part.center = Vec3{u(-.5, .5), u(-.5, .5), u(-.5, .5)};
        part.size = Vec3{u(.12, .45), u(.12, .45), u(.12, .45)};
    }
    parts[0].center *= .3f;
    const float fillet = u(.03, .2);
    const bool mirrored = u.pick(2) == 1;
    return [=](const Vec3& p) {
        const Vec3 q = fold(p, mirrored, false);
        float d = 1e9f;
        for (const Part& part : parts) {
            const Vec3& c = part.center;
            const Vec3& s = part.size;
            const float one = part.kind == 0   ? ellipsoid(q, c, s)
                              : part.kind == 1 ? box(q, c, s, .05f)
                              : part.kind == 2 ? capsule(q, c, c * .2f, s.x * .5f, s.y * .5f)
                                               : cylinder(q, c, s.x, s.y);
            d = d > 1e8f ? one : smooth_merge(fillet, {d, one});
        }
        return d;
    };
}

using Maker = SignedDistance (*)(Draw&);

const std::map<std::string, Maker>& makers() {
    static const std::map<std::string, Maker> table_of_makers{
        {"mug", mug},     {"vase", vase},       {"bowl", bowl},         {"bottle", bottle},
        {"ball", ball},   {"cube", cube},       {"donut", donut},       {"chair", chair},
        {"table", table}, {"lamp", lamp},       {"mushroom", mushroom}, {"apple", apple},
        {"pear", pear},   {"snowman", snowman}, {"house", house},       {"fish", fish},
        {"duck", duck},   {"cow", cow},         {"teapot", teapot},     {"blob", blob}};
    return table_of_makers;
}

}  // namespace

const std::vector<ShapeClass>& shape_classes() {
    static const std::vector<ShapeClass> classes{
        {"mug", {"mug", "cup"}}, {"vase", {"vase"}},           {"bowl", {"bowl"}},
        {"bottle", {"bottle"}},  {"ball", {"ball", "sphere"}}, {"cube", {"cube", "box"}},
        {"donut", {"donut"}},    {"chair", {"chair"}},         {"table", {"table"}},
        {"lamp", {"lamp"}},      {"mushroom", {"mushroom"}},   {"apple", {"apple"}},
        {"pear", {"pear"}},      {"snowman", {"snowman"}},     {"house", {"house"}},
        {"fish", {"fish"}},      {"duck", {"duck"}},           {"cow", {"cow"}},
        {"blob", {"object"}},    {"teapot", {"teapot"}, true}};
    return classes;
}

SignedDistance make_shape(const std::string& shape_class, int variant) {
    const auto maker = makers().find(shape_class);
    ITEM3D_CHECK(maker != makers().end(), "no shape class is called " + shape_class);
    std::uint64_t name = 0;
    for (const char letter : shape_class)
        name = mix_bits(name ^ static_cast<unsigned char>(letter));
    Draw u(Random(name, static_cast<std::uint64_t>(variant)));
    const SignedDistance shape = maker->second(u);
    // A little taller or flatter, thicker or thinner than its class.
    const Vec3 scale{1.0f, u(.88, 1.14), u(.93, 1.07)};
    const float shrink = std::min(scale.x, std::min(scale.y, scale.z));
    return [=](const Vec3& p) { return shape(p / scale) * shrink; };
}

}  // namespace item3d
