// Baking of the neural texture into images, as a change of the source's texels.
//
// Baked texels are not the field's values. The field is a fit, and detail that it cannot represent
// (print, grain) would be lost; so a texel is the source's own plus the edit's change:
//     baked = source + (now - fitted),    base colour sRGB-encoded, all clamped to [0, 1].
//
// An unchanged field returns the source bit for bit. The base colour's residual source - fitted is
// reduced in two ways. First, where the colour changed much, the residual belongs to the previous
// colour: its luminance (the detail) is kept and its chroma fades out, fully where a channel
// changed by a quarter or more. Second, where the edit reduced the local contrast, the residual is
// reduced by the same factor (residual_gain.h), so that a marking that the edit painted over leaves
// no crisp outline. In a texture of few colours, texels that had one colour become one colour again
// (keep_flat.h).
#pragma once

#include "item3d/field/atlas/atlas.h"
#include "item3d/field/neural_texture.h"
#include "item3d/io/save.h"
#include "item3d/render/textured_materials.h"

#include <functional>
#include <map>

namespace item3d {

/// Channels to bake. true: baked from the field. false: kept, texels equal the source's bit for bit
/// (with a new UV map: are resampled from it).
struct BakedChannels {
    bool base_color = true;
    bool occlusion = false;
    bool roughness = true;
    bool metallic = true;
    bool normal = false;
};

struct BakeOptions {
    BakedChannels channels;
    /// Longest edge of the images; 0: that of the source, or of the base colour (see atlas_size).
    int texture_size = 0;
    /// supersampling^2 samples for each texel; those inside a triangle are averaged. Textures
    /// beyond 2048 use one.
    int supersampling = 2;
    /// Largest change of an encoded colour channel at which the residual's chroma begins to fade,
    /// and at which it is gone.
    float chroma_fade_begin = 0.05f;
    float chroma_fade_end = 0.25f;
    /// Root mean square, for values in [0, 1], below which differences that the edit adds within a
    /// texture count as blotches: they are averaged out (keep_flat.h), and a new texture gets no
    /// texels for them (shrink.h).
    float blotch = 1.0f / 255;
    bool show_progress = true;
};

/// Width in texels of the padding around an island: enough for four mip levels.
inline constexpr int texture_padding = 16;

/// Inputs of a bake, which must outlive the call.
struct BakeScene {
    const Model& model;
    const Geometry& geometry;
    const TexturedMaterials& materials;
    const FieldSpace& space;
    const Atlas& atlas;
    /// Returns the weight of the edit at surface points, [P, 1] in [0, 1]. Where it is 0, texels
    /// equal the source's bit for bit. Null: 1 everywhere.
    std::function<at::Tensor(const Surface&)> weight = nullptr;
    /// Base colours painted in UV space, which replace the fields' change: sRGB, of any size, one
    /// image for each texture set, keyed by the set's first material. Null: none.
    const std::map<int, Image>* painted = nullptr;
};

/// Images of one texture set without the edit, in the edited images' sizes. An image is empty if it
/// equals the source's own texels times the factors (source_texels.h), or, without a texture, the
/// factors alone.
struct UneditedImages {
    Image base_color, metallic_roughness, normal;
    /// Weight of the edit at each texel, one channel, in the size of the first image; empty without
    /// BakeScene::weight.
    Image weight;
};

/// Bakes the change from `fitted`, the field before the edit (snapshot()), to `now`, the field
/// after it. Returns images for all edited materials of the atlas and the atlas's new UVs, for
/// save_model(). Uncovered texels continue their neighbours, so that filtering shows no seam. A
/// normal image is made only where the field's normals changed. Vertex colours become part of the
/// base colour's image. unedited: receives the images without the edit, keyed by the first material
/// of each set; may be null. Throws Interrupted after Ctrl-C.
ModelEdit bake(const BakeScene& scene, NeuralTexture& fitted, NeuralTexture& now,
               const BakeOptions& options = {}, std::map<int, UneditedImages>* unedited = nullptr);

}  // namespace item3d
