// Surface, prior and pictures so far, which all methods share that paint texels view after view.
#pragma once

#include "item3d/baselines/texel_list.h"
#include "item3d/baselines/texel_view.h"
#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/render/textured_materials.h"
#include "item3d/scene/camera.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct PaintingScene {
    std::shared_ptr<const DiffusionModel> prior;
    /// With 9 input channels (latents, mask, masked picture's latents); null: latents are blended.
    std::shared_ptr<const DiffusionModel> inpainter;
    Geometry geometry;  ///< atlas_geometry()
    std::unique_ptr<const TexelList> texels;
    std::unique_ptr<const TexelList> latent_texels;  ///< coarser, for latents in texture space
    at::Tensor source;                               ///< [T, 3] the unedited base colour, sRGB
    at::Tensor weight;  ///< [T, 1] how much of the edit each texel takes, 0: none
    const TexturedMaterials* materials = nullptr;  ///< the model's own
    std::vector<Vec3> points;                      ///< that views must frame
    float radius = 1;                              ///< of the model
    std::string prompt, negative_prompt;           ///< empty negative: no text
    bool says_sides = false;  ///< whether the prior understands "front view" and the like
    int resolution = 512;     ///< pixels of the pictures that the prior sees
    /// Depth, position and normal as a prior is told them.
    std::function<SeenShape(const Raster&, const Surface&)> shape;
};

/// A camera around the model, and the side that it sees in words ("front").
struct SideView {
    Camera camera;
    std::string side;
};

/// Angles in degrees, azimuth 0 from the front (+Z), elevation positive above.
struct ViewAngles {
    float azimuth, elevation;
};

/// The side that TEXTure's prompts name: front, right, back and left by 70, 110, 70 and 110 degrees
/// of azimuth; overhead and bottom within 40 degrees of the poles.
std::string side_of(ViewAngles angles);

/// Frames all of the model, as wide as it can.
SideView side_view(const PaintingScene& scene, ViewAngles angles);

/// One view, drawn on S x S pixels, S a multiple of the prior's R.
class ViewRender {
  public:
    /// size: S, 0: what suits the prior. With another one picture() and condition() are not to be
    /// asked.
    ViewRender(const PaintingScene& scene, const SideView& view, int size = 0);

    int size() const { return raster_.width(); }  ///< S
    const SideView& view() const { return view_; }
    at::Tensor depth() const { return raster_.depth[0]; }   ///< [S, S] z-depths, 0: none
    const TexelView& texels() const;                        ///< how it sees them
    const at::Tensor& covered() const { return covered_; }  ///< [1, 1, S, S] 0 or 1
    const at::Tensor& cosine() const { return cosine_; }    ///< [1, 1, S, S]
    /// The colours of a picture [1, 3, R, R] at all texels, of pixels that the model covers wholly:
    /// others are of the background too. share: 0 where it does not see the texel, or where those
    /// pixels have less than a quarter of the weights; else 1.
    PictureSample colors_of(const at::Tensor& picture) const;
    /// [1, 1, S, S] 0 or 1: pixels that take any of the edit.
    const at::Tensor& editable() const { return editable_; }
    /// values [T, C] as pixels [1, C, S, S]; 0 where no edited material is.
    at::Tensor pixels(const at::Tensor& values) const;
    /// colors [T, 3] sRGB without any light, other materials' own base colours beside them,
    /// mid-grey behind: [1, 3, R, R].
    at::Tensor picture(const at::Tensor& colors) const;
    /// The condition that DiffusionModel::predict() takes, for latents of pictures of this view.
    at::Tensor condition(const DiffusionModel& model, const at::Tensor& latents) const;

  private:
    const PaintingScene& scene_;
    SideView view_;
    Raster raster_;
    Surface surface_;
    SeenShape shape_;
    mutable std::optional<TexelView> texel_view_;  ///< once it was asked
    at::Tensor covered_, cosine_, editable_, own_color_;
};

/// [1, 1, S, S] -> [1, 1, h, w]: 1 where any pixel of a cell is not 0.
at::Tensor any_in_cells(const at::Tensor& mask, std::int64_t height, std::int64_t width);

}  // namespace item3d
