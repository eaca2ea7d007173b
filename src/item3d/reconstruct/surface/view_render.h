// Renders of the photographs' views, and the losses between renders and photographs.
#pragma once

#include "item3d/core/random.h"
#include "item3d/field/neural_texture.h"
#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/surface/view_corrections.h"
#include "item3d/render/occlusion/indirect_light.h"
#include "item3d/render/occlusion/occlusion.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/render/shade.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Photograph in the form that the losses use.
struct TargetView {
    std::string name;
    Camera camera;     ///< camera with a depth range around the object
    at::Tensor image;  ///< [1, H, W, 4] premultiplied linear RGB and coverage
    int width() const { return static_cast<int>(image.size(2)); }
    int height() const { return static_cast<int>(image.size(1)); }
};

/// Converts photographs to targets. bounds: box of the object, which sets the cameras' depth
/// ranges. shrink: divisor of the images' width and height.
std::vector<TargetView> make_targets(const std::vector<Photograph>& views,
                                     std::array<Vec3, 2> bounds, int shrink = 1);

struct RenderedView {
    at::Tensor image;         ///< [1, H, W, 4] as in TargetView, antialiased
    at::Tensor without_gain;  ///< `image` without ViewRenderOptions::gain
    Raster raster;
    Surface surface;
    MaterialSample material;
    MaterialSample shaded;  ///< material used in shading, after the options' changes
};

DrawnView as_drawn(const TargetView& view, const RenderedView& rendered);

struct ViewRenderOptions {
    const Occlusion* occlusion = nullptr;  ///< traced occlusion, in place of the material's own
    /// Interreflected light, or null. `seed` determines its random rays.
    const IndirectLight* indirect = nullptr;
    std::uint64_t seed = 0;
    bool normal_map = false;  ///< true if the field's tangent-space normals are used
    /// True if all points have the view's mean material, so that only the light can explain
    /// shading.
    bool one_material = false;
    RigidMotion motion =
        {};                ///< motion of the object in front of the camera; undefined tensors: none
    at::Tensor gain = {};  ///< [3], factor of all radiance; 1 if undefined
    at::Tensor base_color_factor = {};  ///< [3], factor of the shaded base colour; 1 if undefined
};

/// Renders a view. Differentiable in the field, the light, and the geometry's positions and
/// normals.
RenderedView render_view(const Geometry& geometry, NeuralTexture& field,
                         const EnvironmentLight& light, const TargetView& view,
                         const ViewRenderOptions& options = {});

/// Returns sRGB of log(1 + x), a tone curve that continues beyond 1 (nvdiffrec, Munkberg et al.
/// 2022).
at::Tensor log_srgb(const at::Tensor& linear);

/// Returns the mean absolute difference of two images in log_srgb(), both composited over the
/// colour `background` [3].
at::Tensor image_loss(const at::Tensor& rendered, const at::Tensor& target,
                      const at::Tensor& background);

/// Returns the mean squared difference of coverage.
at::Tensor mask_loss(const at::Tensor& rendered, const at::Tensor& target);

/// Returns the mean absolute difference of base colour (sRGB), roughness and metallic between up to
/// `count` of the view's points and a random point near each of them. The distances of these random
/// points are from `nearest` to `farthest`, in world units, with a log-uniform distribution. With
/// squared differences, the large steps at a print's edges would cost more than shading in the base
/// colour, which consists of many small steps.
at::Tensor smoothness_loss(NeuralTexture& field, const RenderedView& view, float nearest,
                           float farthest, std::int64_t count, Random& random);

/// Returns the mean of metallic times the shortfall of the base colour's largest channel from 0.5.
/// Real metals are brighter than that, and a black metal looks like black varnish.
at::Tensor dark_metal_loss(const RenderedView& view);

/// Returns the mean of metallic times the excess of roughness over 0.7: few metals are rougher, and
/// a rough metal looks like paint. Its gradient reaches metallic alone.
at::Tensor rough_metal_loss(const RenderedView& view);

}  // namespace item3d
