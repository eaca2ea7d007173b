#include "item3d/reconstruct/outputs/stage_preview.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/save.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/scatter.h"
#include "item3d/render/srgb.h"

#include <algorithm>

namespace item3d {

namespace {

constexpr std::size_t sides = 3;
constexpr int longest_image_side = 256;
constexpr double page = 0.78;  ///< linear grey of the background

/// Composites a premultiplied linear image [1, H, W, 4] over the background. Returns sRGB [H, W,
/// 3].
at::Tensor over_page(const at::Tensor& image) {
    const at::Tensor color = image.narrow(3, 0, 3) + page * (1 - image.narrow(3, 3, 1));
    return linear_to_srgb(color.clamp(0, 1)).squeeze(0);
}

at::Tensor base_color_image(const RenderedView& view) {
    const at::Tensor& color = view.material.base_color;
    const at::Tensor opaque = at::cat({color, at::ones_like(color.narrow(1, 0, 1))}, 1);
    return scatter(opaque, view.surface, view.raster, at::zeros({4}));
}

/// Concatenates images [H, W, 3] of any heights side by side, aligned at the top.
at::Tensor beside(std::vector<at::Tensor> columns) {
    std::int64_t height = 0;
    for (const at::Tensor& column : columns)
        height = std::max(height, column.size(0));
    for (at::Tensor& column : columns)
        column = at::constant_pad_nd(column, {0, 0, 0, 0, 0, height - column.size(0)}, 1);
    return at::cat(columns, 1).contiguous();
}

}  // namespace

StagePreview::StagePreview(std::filesystem::path path, const Dataset& dataset)
    : path_(std::move(path)) {
    const std::vector<Photograph>& all = dataset.train;
    const int side = std::max(all.front().image.width, all.front().image.height);
    const Vec3 reach(dataset.radius);
    views_ = make_targets(some_views(all, sides), {dataset.centre - reach, dataset.centre + reach},
                          (side + longest_image_side - 1) / longest_image_side);
}

void StagePreview::update(Stage& stage) {
    if (!enabled_) return;
    const at::NoGradGuard no_gradient;
    try {
        std::vector<at::Tensor> columns;
        for (const TargetView& view : views_) {
            const RenderedView drawn = stage.draw(view);
            std::vector<at::Tensor> rows{over_page(view.image), over_page(drawn.image)};
            if (drawn.surface.count() > 0)
                rows.push_back(over_page(base_color_image(drawn)));
            else
                rows.push_back(at::full_like(rows.front(), 1));
            columns.push_back(at::cat(rows, 0));
        }
        save_image(path_, to_image(beside(columns)));
    } catch (const Error& error) {
        warn(std::string("previews stop: ") + error.what());
        enabled_ = false;
    }
}

}  // namespace item3d
