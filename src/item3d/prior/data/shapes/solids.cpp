#include "item3d/prior/data/shapes/solids.h"

namespace item3d {
namespace {

using namespace sdf;

Shape ball(Draw& u) {
    const float r = u(.7, .85);
    return whole([=](const Vec3& p) { return sphere(p, {0, 0, 0}, r); });
}

Shape cube(Draw& u) {
    const float a = u(.5, .58), b = a * u(.85, 1.1), rounding = u(.01, .12);
    return whole([=](const Vec3& p) { return box(p, {0, 0, 0}, {a, b, a}, rounding); });
}

Shape upright_cone(Draw& u) {
    const float r = u(.45, .62), top = u(0, .05), rounding = u(.01, .04);
    return whole([=](const Vec3& p) { return cone(p, -.7f, .8f, r, .02f + top) - rounding; });
}

Shape upright_cylinder(Draw& u) {
    const float r = u(.35, .55), h = u(.45, .8), rounding = u(.02, .08);
    return whole([=](const Vec3& p) { return cylinder(p, {0, 0, 0}, r, h, rounding); });
}

Shape pyramid(Draw& u) {
    const float a = u(.6, .75), h = u(.8, 1.15), rounding = u(.005, .03);
    const bool three = u.pick(3) == 0;
    return whole([=](const Vec3& p) {
        const float slope = 1 / std::hypot(1.0f, a / h);
        float side = -1e9f;
        for (int i = 0; i < (three ? 3 : 4); ++i) {
            const float turn = 2 * pi * static_cast<float>(i) / (three ? 3 : 4);
            const float out = p.x * std::cos(turn) + p.z * std::sin(turn);
            side = std::max(side, (out - a * (.6f * h - p.y) / h * (three ? .6f : 1)) * slope);
        }
        return std::max(side, -.4f * h - p.y) - rounding;
    });
}

Shape star(Draw& u) {
    const float inner = u(.36, .46), thick = u(.12, .22);
    const int points = 5 + (u.pick(4) == 0 ? 1 : 0);
    return whole([=](const Vec3& p) {
        const float step = pi / static_cast<float>(points);
        const float angle = std::atan2(p.x, p.y);
        const float turn = std::abs(angle - 2 * step * std::round(angle / (2 * step)));
        const float r = std::hypot(p.x, p.y);
        // Edge of the star's outline from a tip (radius .9) to a notch. Both faces rise from the
        // outline to the middle.
        const Vec2 tip(.9f, 0), notch(inner * .9f * std::cos(step), inner * .9f * std::sin(step));
        const Vec2 edge = notch - tip;
        const Vec2 outwards = glm::normalize(Vec2(edge.y, -edge.x));
        const float off = glm::dot(Vec2(r * std::cos(turn), r * std::sin(turn)) - tip, outwards);
        return std::max((off * .55f + std::abs(p.z) - .01f) * .85f, std::abs(p.z) - thick) - .02f;
    });
}

Shape heart(Draw& u) {
    const float thick = u(.24, .34), lobe = u(.36, .42), x = u(.28, .33);
    return whole([=](const Vec3& p) {
        const Vec3 q(std::abs(p.x), p.y - .2f, p.z * lobe / thick);
        const float body =
            smooth_merge(.1f, {capsule(q, {x, .1f, 0}, {.03f, -.72f, 0}, lobe, .05f),
                               capsule(q, {x * .4f, -.1f, 0}, {0, -.6f, 0}, lobe * .8f, .1f)});
        return body * .75f;
    });
}

Shape gear(Draw& u) {
    const float r = u(.55, .65), thick = u(.12, .22), hole = u(.16, .28);
    const auto teeth = static_cast<float>(8 + u.pick(6));
    const float depth = u(.13, .18);
    return whole([=](const Vec3& p) {
        const float radius = std::hypot(p.x, p.y);
        const float wave = std::sin(std::atan2(p.y, p.x) * teeth);
        const float tooth = depth * glm::clamp(wave * 2.2f, -.5f, .5f);
        const float rim = (radius - r - depth * .5f - tooth) * .7f;
        return std::max(std::max(rim, hole - radius), std::abs(p.z) - thick);
    });
}

Shape ring(Draw& u) {
    const float r = u(.62, .72), tube = u(.06, .1), stone = u(.17, .24);
    return {{{"",
              [=](const Vec3& p) {
                  return torus(p, {0, -.15f, 0}, r, tube, 2);
              }},
             {"gem", [=](const Vec3& p) {
                  const Vec3 q(p.x, p.y - r + .15f - stone * .8f, p.z);
                  const float side = std::abs(std::hypot(q.x, q.z));
                  return std::max((side + std::max(-q.y, q.y * .8f)) * .75f - stone,
                                  q.y - stone * .45f);
              }}}};
}

Shape diamond(Draw& u) {
    const float r = u(.65, .75), top = u(.2, .28), table = u(.5, .62);
    const auto sides = static_cast<float>(6 + 2 * u.pick(2));
    return whole([=](const Vec3& p) {
        const float step = 2 * pi / sides;
        const float angle = std::atan2(p.z, p.x);
        const float turn = angle - step * std::round(angle / step);
        const float out = std::hypot(p.x, p.z) * std::cos(turn);
        const float y = p.y - .3f;
        const float crown_slope = top / (r * (1 - table));
        const float pavilion = (out - r * (1 + y / 1.0f)) / std::hypot(1.0f, r);
        const float bezel = (y - crown_slope * (r - out)) / std::hypot(1.0f, crown_slope);
        return std::max(std::max(pavilion, bezel), std::max(y - top, out - r));
    });
}

Shape spring(Draw& u) {
    const float r = u(.38, .48), wire = u(.075, .1);
    const auto turns = static_cast<float>(3 + u.pick(3));
    return whole([=](const Vec3& p) {
        const float pitch = 1.4f / turns;
        const float phase = std::atan2(p.z, p.x) / (2 * pi);
        const float turn = glm::clamp(std::round((p.y + .7f) / pitch - phase), 0.0f, turns - 1);
        const float y = -.7f + (turn + phase) * pitch;
        return std::hypot(std::hypot(p.x, p.z) - r, p.y - y) * .9f - wire;
    });
}

/// Random shape, to make "object" a word for shapes without a name.
Shape blob(Draw& u) {
    struct Piece {
        int kind;
        Vec3 center;
        Vec3 size;
    };
    std::vector<Piece> pieces(static_cast<std::size_t>(3 + u.pick(5)));
    for (Piece& piece : pieces) {
        piece.kind = u.pick(4);
        piece.center = Vec3{u(-.5, .5), u(-.5, .5), u(-.5, .5)};
        piece.size = Vec3{u(.12, .45), u(.12, .45), u(.12, .45)};
    }
    pieces[0].center *= .3f;
    const float fillet = u(.03, .2);
    const bool mirrored = u.pick(2) == 1;
    return whole([=](const Vec3& p) {
        const Vec3 q = fold(p, mirrored, false);
        float d = 1e9f;
        for (const Piece& piece : pieces) {
            const Vec3& c = piece.center;
            const Vec3& s = piece.size;
            const float one = piece.kind == 0   ? ellipsoid(q, c, s)
                              : piece.kind == 1 ? box(q, c, s, .05f)
                              : piece.kind == 2 ? capsule(q, c, c * .2f, s.x * .5f, s.y * .5f)
                                                : cylinder(q, c, s.x, s.y);
            d = d > 1e8f ? one : smooth_merge(fillet, {d, one});
        }
        return d;
    });
}

}  // namespace

std::vector<ShapeMaker> solid_shapes() {
    return {{{"ball", {"ball", "sphere"}}, ball}, {{"cube", {"cube", "box"}}, cube},
            {{"cone", {"cone"}}, upright_cone},   {{"cylinder", {"cylinder"}}, upright_cylinder},
            {{"pyramid", {"pyramid"}}, pyramid},  {{"star", {"star"}}, star},
            {{"heart", {"heart"}}, heart},        {{"gear", {"gear"}}, gear},
            {{"ring", {"ring"}}, ring},           {{"diamond", {"diamond"}}, diamond},
            {{"spring", {"spring"}}, spring},     {{"blob", {"object"}}, blob}};
}

}  // namespace item3d
