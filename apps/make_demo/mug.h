// The demo model: a glazed mug, its shape, its UV layout and its painted textures.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d::demo {

/// A point of the mug's skin, found back from a texel.
struct SkinPoint {
    Vec3 position{0};
    float inside = 0;     ///< 1 on the inner wall and the inner bottom
    float underside = 0;  ///< arc length in metres from the middle of the underside; < 0: elsewhere
    float handle = 0;     ///< 1 on the handle
};

/// A mug of 9.5 cm standing on y = 0, axis +Y, handle towards +X; metres. UVs in [0, 1], no
/// overlap, one scale (uv per metre) for all islands.
class Mug {
  public:
    Mug();
    const Primitive& primitive() const { return primitive_; }
    /// The skin at `uv`; between islands, the continuation of the nearest one, so that filtering
    /// across an island's border stays right.
    SkinPoint skin(Vec2 uv) const;

  private:
    /// A stretch of the profile, lathed: a strip of the UV square, or a disc when it meets the
    /// axis.
    struct Lathe {
        std::vector<Vec2> profile;  ///< (radius, height), in metres
        std::vector<float> length;  ///< arc length up to each point
        Vec2 corner{0};             ///< lower corner in UV; the disc's centre
        float width = 0;            ///< of the strip in UV
        bool disc = false;
        float inside = 0;
    };
    /// From arc length along the profile (metres) and turn about the axis ([0, 1]) to UV, and back.
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

/// Red glaze with fine iron speckles, thinner at the rim; a ring of bare clay under the foot.
MugTextures paint(const Mug& mug, int size);

/// The whole model with its textures, ready to be saved.
Model make_mug(int texture_size);

}  // namespace item3d::demo
