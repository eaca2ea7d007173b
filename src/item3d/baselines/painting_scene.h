// The surface, prior and state shared by methods that paint texels view after view.
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
    /// Network with 9 input channels (latents, mask, masked image's latents); null: latents are
    /// blended.
    std::shared_ptr<const DiffusionModel> inpainter;
    Geometry geometry;  ///< atlas_geometry()
    std::unique_ptr<const TexelList> texels;
    std::unique_ptr<const TexelList> latent_texels;  ///< coarser, for latents in texture space
    at::Tensor source;                               ///< [T, 3] unedited base colour, sRGB
    at::Tensor weight;                               ///< [T, 1] weight of the edit, 0: none
    const TexturedMaterials* materials = nullptr;    ///< the model's own
    std::vector<Vec3> points;                        ///< points that views must frame
    float radius = 1;                                ///< of the model
    std::string prompt, negative_prompt;             ///< empty negative: no text
    bool says_sides = false;  ///< the prior understands "front view" and the like
    int resolution = 512;     ///< pixels of the prior's images
    /// Returns depth, position and normal as input of the prior.
    std::function<SeenShape(const Raster&, const Surface&)> shape;
};

/// A camera around the model, and the name of the side that it sees ("front").
struct SideView {
    Camera camera;
    std::string side;
};

/// Angles in degrees, azimuth 0 from the front (+Z), elevation positive above.
struct ViewAngles {
    float azimuth, elevation;
};

/// Returns the side's name in TEXTure's prompts: front, right, back and left by 70, 110, 70 and 110
/// degrees of azimuth; overhead and bottom within 40 degrees of the poles.
std::string side_of(ViewAngles angles);

/// Returns a camera that frames the whole model as large as possible.
SideView side_view(const PaintingScene& scene, ViewAngles angles);

/// One view, rendered with S x S pixels, S a multiple of the prior's R.
class ViewRender {
  public:
    /// size: S, 0: chosen for the prior. With another size image() and condition() are
    /// unavailable.
    ViewRender(const PaintingScene& scene, const SideView& view, int size = 0);

    int size() const { return raster_.width(); }  ///< S
    const SideView& view() const { return view_; }
    at::Tensor depth() const { return raster_.depth[0]; }   ///< [S, S] z-depths, 0: none
    const TexelView& texels() const;                        ///< projection of the texels
    const at::Tensor& covered() const { return covered_; }  ///< [1, 1, S, S] 0 or 1
    const at::Tensor& cosine() const { return cosine_; }    ///< [1, 1, S, S]
    /// Returns the colours of an image [1, 3, R, R] at all texels. Only pixels that the model
    /// covers fully are sampled, since others include the background. share: 0 for invisible
    /// texels, and for texels with less than a quarter of their bilinear weight on such pixels;
    /// else 1.
    ImageSample colors_of(const at::Tensor& image) const;
    /// Returns [1, 1, S, S] 0 or 1: pixels with any weight of the edit.
    const at::Tensor& editable() const { return editable_; }
    /// Returns values [T, C] as pixels [1, C, S, S]; 0 outside of edited materials.
    at::Tensor pixels(const at::Tensor& values) const;
    /// Renders colors [T, 3] sRGB unlit, with other materials' own base colours, on mid-grey: [1,
    /// 3, R, R].
    at::Tensor image(const at::Tensor& colors) const;
    /// Returns the condition of DiffusionModel::predict() for latents of this view's images.
    at::Tensor condition(const DiffusionModel& model, const at::Tensor& latents) const;

  private:
    const PaintingScene& scene_;
    SideView view_;
    Raster raster_;
    Surface surface_;
    SeenShape shape_;
    mutable std::optional<TexelView> texel_view_;  ///< computed on demand
    at::Tensor covered_, cosine_, editable_, own_color_;
};

/// Maps [1, 1, S, S] to [1, 1, h, w]: 1 where any pixel of a cell is not 0.
at::Tensor any_in_cells(const at::Tensor& mask, std::int64_t height, std::int64_t width);

}  // namespace item3d
