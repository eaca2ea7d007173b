// Baking of the neural texture into images, as a change of the source's texels.
//
// Baked texels are not the values of the neural texture (the field). The field is a fit, and detail
// that it cannot represent (print, grain) would be lost. So a texel is the source's own texel plus
// the edit's change:
//     baked = source + (now - fitted)
//
// `fitted` is the field before the edit and `now` the field after it. The base colour is in sRGB
// encoding, and all values are clamped to [0, 1]. An unchanged field returns the source bit for
// bit. The base colour's residual, source - fitted, is reduced in two ways. First, where the colour
// changed much, the residual belongs to the previous colour. Its luminance, which is the detail, is
// kept. Its chroma fades out, fully where a channel changed by a quarter or more. Second, where the
// edit reduced the local contrast, the residual is reduced by the same factor (residual_gain.h), so
// that a marking that the edit painted over leaves no crisp outline. In a texture of few colours,
// texels that had one colour become one colour again (keep_flat.h).
#pragma once

#include "item3d/field/atlas/atlas.h"
#include "item3d/field/neural_texture.h"
#include "item3d/io/save.h"
#include "item3d/render/textured_materials.h"

#include <functional>
#include <map>

namespace item3d {

/// Channels to bake. A channel that is true is baked from the field. A channel that is false keeps
/// the source's texels bit for bit; with a new UV map its texels are resampled from the source's.
struct BakedChannels {
    bool base_color = true;
    bool occlusion = false;
    bool roughness = true;
    bool metallic = true;
    bool normal = false;
};

struct BakeOptions {
    BakedChannels channels;
    /// Longest edge of the images. If it is 0, the images have the size of the source's images, or
    /// that of atlas_size() if there are none.
    int texture_size = 0;
    /// Each texel has supersampling^2 samples, and those inside a triangle are averaged. Textures
    /// with an edge above 2048 have one sample for each texel.
    int supersampling = 2;
    /// Change of an encoded colour channel at which the residual's chroma begins to fade, and
    /// change at which it is gone. The largest change of the three channels counts.
    float chroma_fade_begin = 0.05f;
    float chroma_fade_end = 0.25f;
    /// Root mean square, for values in [0, 1], below which differences that the edit adds within a
    /// texture count as blotches. They are averaged out (keep_flat.h), and a new texture gets no
    /// texels for them (shrink.h).
    float blotch = 1.0f / 255;
    bool show_progress = true;
};

/// Width in texels of the padding around an island, which suffices for four mip levels.
inline constexpr int texture_padding = 16;

/// The inputs of a bake, which must outlive the call.
struct BakeScene {
    const Model& model;
    const Geometry& geometry;
    const TexturedMaterials& materials;
    const FieldSpace& space;
    const Atlas& atlas;
    /// Returns the weight of the edit at surface points, [P, 1] in [0, 1]. Where it is 0, texels
    /// equal the source's bit for bit. If this is null, the weight is 1 everywhere.
    std::function<at::Tensor(const Surface&)> weight = nullptr;
    /// Base colours painted in UV space, which replace the fields' change. There is one sRGB image
    /// of any size for each texture set, keyed by the set's first material. May be null.
    const std::map<int, Image>* painted = nullptr;
};

/// The images of one texture set without the edit, in the edited images' sizes. An image is empty
/// if it equals the source's own texels times the factors (source_texels.h), or the factors alone
/// if there is no texture.
struct UneditedImages {
    Image base_color, metallic_roughness, normal;
    /// Weight of the edit at each texel, with one channel, in the size of the first image. Empty if
    /// BakeScene::weight is null.
    Image weight;
};

/// Bakes the change from `fitted`, the field before the edit (snapshot()), to `now`, the field
/// after it. Returns, for save_model(), the images of all edited materials of the atlas, and the
/// atlas's new UVs. Uncovered texels continue their neighbours, so that filtering shows no seam. A
/// material gets a normal image only if the field's normals changed. Vertex colours become part of
/// the base colour's image. unedited: receives the images without the edit, keyed by the first
/// material of each set; may be null. Throws Interrupted after Ctrl-C.
ModelEdit bake(const BakeScene& scene, NeuralTexture& fitted, NeuralTexture& now,
               const BakeOptions& options = {}, std::map<int, UneditedImages>* unedited = nullptr);

}  // namespace item3d
