// The neural texture back into images: what an edit changed, texel by texel.
//
// Baked texels are not the field's values. The field is a fit, and what it could not represent
// (print, grain) would be lost; so a texel is the source's own plus what the edit changed:
//     baked = source + (now - fitted),    base colour sRGB-encoded, all clamped to [0, 1].
// A field that was not changed returns the source to the bit. Of the base colour's remainder
// source - fitted two things are taken away. Where the colour moved far, the remainder belongs to a
// colour that is gone: its luminance is kept (the detail) and its chroma fades out, fully where a
// channel moved by a quarter or more. And it fades with the contrast around it (remainder_gain.h):
// of a marking that the edit painted over no crisp outline stays. Texels of one colour in a texture
// of few colours become one colour again (keep_flat.h).
#pragma once

#include "item3d/field/atlas/atlas.h"
#include "item3d/field/neural_texture.h"
#include "item3d/io/save.h"
#include "item3d/render/textured_materials.h"

#include <functional>
#include <map>

namespace item3d {

/// True: baked from the field. False: kept, texels stay bit for bit as they are in the source (with
/// a new UV map: are resampled from it).
struct BakedChannels {
    bool base_color = true;
    bool occlusion = false;
    bool roughness = true;
    bool metallic = true;
    bool normal = false;
};

struct BakeOptions {
    BakedChannels channels;
    /// Longest edge of the images; 0: each as its source, or as the base colour's (see atlas_size).
    int texture_size = 0;
    /// supersampling^2 samples a texel; those inside a triangle are averaged. Textures beyond 2048
    /// take one.
    int supersampling = 2;
    /// Fading of the remainder's chroma: begins and ends where the largest change of an encoded
    /// channel is this.
    float chroma_fade_begin = 0.05f;
    float chroma_fade_end = 0.25f;
    /// Root mean square, in values of [0, 1], below which a difference within a texture that the
    /// source did not have is a blotch and takes no texels.
    float blotch = 1.0f / 255;
    bool show_progress = true;
};

/// Texels around an island that continue it: enough for four mip levels.
inline constexpr int texture_padding = 16;

/// What is baked from. All must live as long as the call.
struct BakeScene {
    const Model& model;
    const Geometry& geometry;
    const TexturedMaterials& materials;
    const FieldSpace& space;
    const Atlas& atlas;
    /// Of a place: how much of the edit it takes, [P, 1] in [0, 1]. Where it is 0 texels stay bit
    /// for bit, where they are the source's own. Null: all of it everywhere.
    std::function<at::Tensor(const Surface&)> weight = nullptr;
    /// Base colours that were painted into UV space, in place of what the fields changed: sRGB, of
    /// any size, by the first material of each texture set. Null: none.
    const std::map<int, Image>* painted = nullptr;
};

/// Of one texture set: its pictures as they were without the edit, each of the edited one's size.
/// Empty where those are the source's own texels with the factors multiplied in (source_texels.h),
/// or the factors alone where the source has no texture.
struct UneditedPictures {
    Image base_color, metallic_roughness, normal;
    /// How much of the edit each texel takes, one channel, of the first of the pictures; empty
    /// without BakeScene::weight.
    Image weight;
};

/// fitted: the field before the edit (`snapshot`), now: after it. Returns images for all edited
/// materials of the atlas and the atlas's new UVs, ready for save_model. Texels that no triangle
/// covers continue their neighbours, so that filtering finds no seam. A normal image is only made
/// where the field's normals changed. Vertex colours become part of the base colour's image.
/// unedited: takes what there was before, by the first material of each set; null: nobody asks.
/// Throws Interrupted after Ctrl-C.
ModelEdit bake(const BakeScene& scene, NeuralTexture& fitted, NeuralTexture& now,
               const BakeOptions& options = {},
               std::map<int, UneditedPictures>* unedited = nullptr);

}  // namespace item3d
