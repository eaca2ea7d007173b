#include "item3d/reconstruct/outputs/truth.h"

#include "item3d/core/error.h"
#include "item3d/io/load.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/interpolate.h"
#include "item3d/render/rasterize.h"
#include "item3d/render/srgb.h"
#include "item3d/render/textured_materials.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

/// Returns an image as rows, [pixels, channels].
at::Tensor rows_of(const Image& image) {
    return to_tensor(image).reshape({-1, image.channels});
}

/// Pixels of a view that both the model and the reference cover.
struct SharedPixels {
    at::Tensor pixel;                        ///< [P] int64
    at::Tensor base_color, true_base_color;  ///< [P, 3] linear
    at::Tensor orm, true_orm;                ///< [P, 3]; true_orm: undefined without NAME_orm.png
};

Image load_truth(const std::filesystem::path& path, const TargetView& view) {
    Image image = load_image(path);
    if (image.width != view.width() || image.height != view.height())
        throw InputError(path.string(), "does not have the size of its test view",
                         "give images of the same size");
    if (image.channels < 3) throw InputError(path.string(), "has no colours", "give an RGB image");
    return image;
}

SharedPixels shared_pixels(const Geometry& geometry, const TexturedMaterials& materials,
                           const TargetView& view, const std::filesystem::path& stem) {
    const Image truth = load_truth(stem.string() + "_albedo.png", view);
    const std::vector<Camera> cameras{view.camera};
    const Raster raster = rasterize(geometry, cameras, view.width(), view.height());
    const Surface surface = interpolate_surface(geometry, raster, cameras);
    SharedPixels shared;
    const at::Tensor colors = rows_of(truth).index_select(0, surface.pixel);
    const at::Tensor covered =
        truth.channels == 4
            ? colors.select(1, 3) > 0.99f
            : view.image.reshape({-1, 4}).select(1, 3).index_select(0, surface.pixel) > 0.99f;
    const at::Tensor kept = covered.nonzero().flatten();
    const MaterialSample sample = materials.sample(surface);
    shared.pixel = surface.pixel.index_select(0, kept);
    shared.base_color = sample.base_color.index_select(0, kept);
    shared.orm = sample.orm.index_select(0, kept);
    shared.true_base_color = srgb_to_linear(colors.narrow(1, 0, 3).index_select(0, kept));
    const std::filesystem::path orm = stem.string() + "_orm.png";
    if (std::filesystem::exists(orm))
        shared.true_orm =
            rows_of(load_truth(orm, view)).narrow(1, 0, 3).index_select(0, shared.pixel);
    return shared;
}

/// Returns an image with `values` at the pixels `pixel` and white at all others.
Image map_of(const TargetView& view, const at::Tensor& pixel, const at::Tensor& values) {
    at::Tensor rows = at::ones({static_cast<std::int64_t>(view.width()) * view.height(), 3});
    rows.index_copy_(0, pixel, values.clamp(0, 1));
    return to_image(rows.reshape({view.height(), view.width(), 3}));
}

at::Tensor material_of(const at::Tensor& orm) {
    return at::cat({at::zeros_like(orm.narrow(1, 0, 1)), orm.narrow(1, 1, 2)}, 1);
}

}  // namespace

MaterialTruth compare_materials(const Model& model, const std::vector<TargetView>& views,
                                const std::filesystem::path& folder) {
    const at::NoGradGuard no_gradient;
    const Geometry geometry = Geometry::from_model(model);
    const TexturedMaterials materials(model);
    std::vector<std::pair<const TargetView*, SharedPixels>> all;
    at::Tensor product = at::zeros({3}, at::kDouble), square = at::zeros({3}, at::kDouble);
    for (const TargetView& view : views) {
        const std::filesystem::path stem =
            folder / std::filesystem::path(view.name).filename().stem();
        if (!std::filesystem::exists(stem.string() + "_albedo.png")) continue;
        const SharedPixels& shared =
            all.emplace_back(&view, shared_pixels(geometry, materials, view, stem)).second;
        product += (shared.base_color * shared.true_base_color).sum(0).to(at::kDouble);
        square += shared.base_color.square().sum(0).to(at::kDouble);
    }
    if (all.empty())
        throw InputError(folder.string(), "contains no image with the name of a test view",
                         "name them NAME_albedo.png and NAME_orm.png");
    const at::Tensor gain = (product / square.clamp_min(1e-12)).to(at::kFloat);

    MaterialTruth truth;
    truth.base_color_gain = {gain[0].item<float>(), gain[1].item<float>(), gain[2].item<float>()};
    double squares = 0, right = 0, roughness = 0, pixels = 0, material_pixels = 0;
    for (const auto& [view, shared] : all) {
        const at::Tensor found = linear_to_srgb((shared.base_color * gain).clamp(0, 1));
        const at::Tensor wanted = linear_to_srgb(shared.true_base_color);
        squares += (found - wanted).square().mean(1).sum().item<double>();
        const auto count = static_cast<double>(shared.pixel.size(0));
        pixels += count;
        MaterialMaps maps{view->name,
                          map_of(*view, shared.pixel, wanted),
                          map_of(*view, shared.pixel, found),
                          {},
                          {}};
        if (shared.true_orm.defined()) {
            const at::Tensor is_metal = shared.orm.select(1, 2) > 0.5f;
            right += is_metal.eq(shared.true_orm.select(1, 2) > 0.5f).sum().item<double>();
            roughness +=
                (shared.orm.select(1, 1) - shared.true_orm.select(1, 1)).abs().sum().item<double>();
            material_pixels += count;
            maps.true_material = map_of(*view, shared.pixel, material_of(shared.true_orm));
            maps.material = map_of(*view, shared.pixel, material_of(shared.orm));
        }
        truth.views.push_back(std::move(maps));
    }
    truth.base_color_psnr = -10 * std::log10(std::max(squares / std::max(pixels, 1.0), 1e-12));
    truth.metallic_right = right / std::max(material_pixels, 1.0);
    truth.roughness_error = roughness / std::max(material_pixels, 1.0);
    return truth;
}

}  // namespace item3d
