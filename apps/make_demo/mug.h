// The demo model, a glazed mug: its shape, its UV layout and its painted textures.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d::demo {

/// The point on the mug's surface that belongs to a texel.
struct SkinPoint {
    Vec3 position{0};
    float inside = 0;     ///< 1 on the inner wall and the inner bottom
    float underside = 0;  ///< arc length in metres from the middle of the underside; < 0 elsewhere
    float handle = 0;     ///< 1 on the handle
};

/// A mug 9.5 cm high that stands on y = 0. Its axis is +Y, and its handle points towards +X.
/// Lengths are in metres. UVs are in [0, 1], without overlap, and all islands have the same scale
/// (uv per metre).
class Mug {
  public:
    Mug();
    const Primitive& primitive() const { return primitive_; }
    /// Returns the surface point at `uv`. Between islands the nearest island is continued, so that
    /// filtering across its border is correct.
    SkinPoint skin(Vec2 uv) const;

  private:
    /// A part of the profile as a surface of revolution. In the UV square it is a strip, or a disc
    /// if it meets the axis.
    struct Lathe {
        std::vector<Vec2> profile;  ///< (radius, height), in metres
        std::vector<float> length;  ///< arc length up to each point
        Vec2 corner{0};             ///< lower corner in UV; for a disc, its centre
        float width = 0;            ///< width of the strip in UV
        bool disc = false;
        float inside = 0;
    };
    /// Converts between UV and the pair (arc length along the profile in metres, turn about the
    /// axis in [0, 1]).
    static Vec2 lathe_uv(const Lathe& lathe, float distance, float turn);
    static Vec2 lathe_place(const Lathe& lathe, Vec2 uv);
    void add_lathe(const Lathe& lathe);
    void add_handle();
    Vec3 handle_point(float along, float around) const;
    static Vec2 profile_at(const Lathe& lathe, float distance);

    Primitive primitive_;
    std::vector<Lathe> lathes_;
    Vec2 handle_corner_{0};
    Vec2 handle_size_{0};
};

struct MugTextures {
    Image base_color;  ///< sRGB, 3 channels
    Image orm;         ///< occlusion, roughness, metallic, linear
};

/// Paints red glaze with fine iron speckles, thinner at the rim, and a ring of bare clay under the
/// foot.
MugTextures paint(const Mug& mug, int size);

/// Returns the whole model with its textures.
Model make_mug(int texture_size);

}  // namespace item3d::demo
