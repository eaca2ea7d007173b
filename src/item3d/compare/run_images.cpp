#include "item3d/compare/run_images.h"

#include "item3d/core/files.h"
#include "item3d/core/names.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/render/image_tensor.h"
#include "item3d/report/animation.h"
#include "item3d/report/model_images.h"

#include <algorithm>

namespace item3d {
namespace {

constexpr std::size_t shown_views[] = {1,
                                       4};  ///< indices of the two shown views, from opposite sides

/// Returns the images [N, 3, H, W] side by side.
Image strip(const at::Tensor& images) {
    std::vector<at::Tensor> parts;
    for (std::int64_t i = 0; i < images.size(0); ++i)
        parts.push_back(images[i]);
    return to_image(at::cat(parts, 2).permute({1, 2, 0}).contiguous());
}

void write_strip(const std::filesystem::path& file, const at::Tensor& images) {
    write_atomically(file, encode_webp(strip(images)));
}

at::Tensor two_of(const at::Tensor& views) {
    return at::stack({views[static_cast<std::int64_t>(shown_views[0])],
                      views[static_cast<std::int64_t>(shown_views[1])]});
}

at::Tensor drawn(const Model& model, const Image& light, const std::vector<Camera>& cameras) {
    return over_white(draw_images(model, prefilter(light, light_texels(run_view_pixels)), cameras,
                                  run_view_pixels));
}

/// Returns the images that the method drew, at most run_view_count, as [N, 3, H, W].
at::Tensor painted_views(const std::filesystem::path& folder,
                         const std::vector<std::string>& files) {
    std::vector<at::Tensor> views;
    for (std::size_t i = 0; i < std::min<std::size_t>(files.size(), run_view_count); ++i)
        views.push_back(
            to_tensor(load_image(folder / files[i])).narrow(2, 0, 3).permute({2, 0, 1}));
    return at::stack(views);
}

std::string lit_name(bool before, const std::string& light) {
    return (before ? "before-" : "view-") + slug(light) + ".webp";
}

}  // namespace

void write_run_images(const CompareRun& run, const RunModels& models,
                      const std::vector<Camera>& cameras, const at::Tensor& views,
                      const std::vector<std::string>& painted, const ImageWishes& wishes) {
    const std::vector<Camera> two = {cameras[shown_views[0]], cameras[shown_views[1]]};
    write_strip(run.folder / "view.webp", two_of(views));
    if (wishes.all_views) {
        write_strip(run.folder / "around.webp",
                    painted.empty() ? views : painted_views(run.folder, painted));
        const at::Tensor all = drawn(models.before, models.light_before, cameras);
        write_strip(run.folder / "before-around.webp", all);
        write_strip(run.folder / "before.webp", two_of(all));
    } else {
        write_strip(run.folder / "before.webp", drawn(models.before, models.light_before, two));
    }
    for (const std::string& name : wishes.lights) {
        const Image light = load_light(name);
        write_strip(run.folder / lit_name(true, name), drawn(models.before, light, two));
        write_strip(run.folder / lit_name(false, name), drawn(models.after, light, two));
    }
}

nlohmann::json images_of_run(const ImageWishes& wishes, bool before) {
    nlohmann::json images = nlohmann::json::array();
    images.push_back(
        {{"file", before ? "before.webp" : "view.webp"}, {"caption", "in the edit's light"}});
    if (wishes.all_views)
        images.push_back({{"file", before ? "before-around.webp" : "around.webp"},
                          {"caption", before ? "around the model" : "as generated"}});
    for (const std::string& light : wishes.lights)
        images.push_back({{"file", lit_name(before, light)}, {"caption", light}});
    return images;
}

}  // namespace item3d
