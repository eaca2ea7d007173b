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
    /// Network with 9 input channels (latents, mask, masked image's latents). If it is null, the
    /// prior's latents are blended instead (masked_sampling.h).
    std::shared_ptr<const DiffusionModel> inpainter;
    Geometry geometry;  ///< atlas_geometry()
    std::unique_ptr<const TexelList> texels;
    std::unique_ptr<const TexelList> latent_texels;  ///< a coarser list, for latents
    at::Tensor source;                               ///< [T, 3] unedited base colour, sRGB
    at::Tensor weight;                               ///< [T, 1] weight of the edit, 0: none
    const TexturedMaterials* materials = nullptr;    ///< materials of the unedited model
    std::vector<Vec3> points;                        ///< points that views must frame
    float radius = 1;                                ///< radius of the model
    std::string prompt, negative_prompt;             ///< an empty negative prompt means no text
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

/// Angles in degrees. A camera at azimuth 0 sees the model from the front (+Z); a positive
/// elevation is above the model.
struct ViewAngles {
    float azimuth, elevation;
};

/// Returns the side's name in TEXTure's prompts. It is "overhead" or "bottom" within 40 degrees of
/// a pole; elsewhere "front" or "back" in a range of 70 degrees of azimuth, "right" or "left" in a
/// range of 110 degrees.
std::string side_of(ViewAngles angles);

/// Returns a camera that frames the whole model as large as possible.
SideView side_view(const PaintingScene& scene, ViewAngles angles);

/// One view, rendered with S x S pixels. S is a multiple of R, the number of pixels along an edge
/// of the prior's images.
class ViewRender {
  public:
    /// size: S; 0 chooses S for the prior. image() and condition() may be called only if `size` is
    /// 0.
    ViewRender(const PaintingScene& scene, const SideView& view, int size = 0);

    int size() const { return raster_.width(); }  ///< S
    const SideView& view() const { return view_; }
    at::Tensor depth() const { return raster_.depth[0]; }   ///< [S, S] z-depths, 0: no surface
    const TexelView& texels() const;                        ///< the texels' projection
    const at::Tensor& covered() const { return covered_; }  ///< [1, 1, S, S] 0 or 1
    const at::Tensor& cosine() const { return cosine_; }    ///< [1, 1, S, S]
    /// Returns the colours of an image [1, 3, R, R] at all texels. Samples only pixels that the
    /// model covers fully, since others include the background. `share` of the result is 1 for
    /// visible texels with more than a quarter of their bilinear weight on such pixels, else 0.
    ImageSample colors_of(const at::Tensor& image) const;
    /// Returns [1, 1, S, S]: 1 for pixels at which the edit's weight is not 0, else 0.
    const at::Tensor& editable() const { return editable_; }
    /// Returns the texels' values [T, C] as an image [1, C, S, S], which is 0 outside of the edited
    /// materials.
    at::Tensor pixels(const at::Tensor& values) const;
    /// Renders the texels' colours [T, 3], in sRGB, without light, on a mid-grey background.
    /// Materials that are not edited have their own base colours. Returns [1, 3, R, R].
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

/// Reduces a mask [1, 1, S, S] to [1, 1, h, w]: 1 where any pixel of the cell is not 0, else 0.
at::Tensor any_in_cells(const at::Tensor& mask, std::int64_t height, std::int64_t width);

}  // namespace item3d
