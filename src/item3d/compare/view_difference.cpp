#include "item3d/compare/view_difference.h"

#include "item3d/baselines/texel_view.h"
#include "item3d/core/error.h"
#include "item3d/region/color_selector.h"
#include "item3d/render/srgb.h"

#include <cmath>
#include <limits>

namespace item3d {
namespace {

constexpr double min_cosine = 0.5;
constexpr double whole_share = 0.999;
constexpr float tolerance = 0.01f;  ///< depth behind the visible surface, relative to the radius

}  // namespace

PointColors colors_of_points(const Surface& points, const Camera& camera, const at::Tensor& depth,
                             const at::Tensor& image, const at::Tensor& counts, double radius) {
    const TexelView view =
        see_texels(points, camera, depth, tolerance * static_cast<float>(radius));
    const ImageSample sample = sample_pixels(image, counts, view.place);
    return {sample.values, (view.cosine > min_cosine) & (sample.share > whole_share)};
}

double view_difference(const std::vector<PointColors>& views) {
    const at::NoGradGuard no_grad;
    double sum = 0, count = 0;
    std::vector<at::Tensor> labs;
    for (const PointColors& view : views) {
        ITEM3D_CHECK(view.colors.dim() == 2 && view.colors.size(1) == 3 &&
                         view.seen.size(0) == view.colors.size(0),
                     "colours must be [P, 3], what is seen [P]");
        labs.push_back(lab_of(srgb_to_linear(view.colors.to(at::kFloat).clamp(0, 1)).cpu()));
    }
    for (std::size_t a = 0; a < views.size(); ++a) {
        for (std::size_t b = a + 1; b < views.size(); ++b) {
            const at::Tensor both = (views[a].seen & views[b].seen).to(at::kDouble).cpu();
            const at::Tensor apart = (labs[a] - labs[b]).square().sum(1).sqrt();
            sum += (apart * both).sum().item<double>();
            count += both.sum().item<double>();
        }
    }
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace item3d
