#include "item3d/edit/outputs/edit_images.h"

#include "item3d/core/files.h"
#include "item3d/edit/material_source.h"
#include "item3d/io/save.h"
#include "item3d/lighting/environment.h"
#include "item3d/processes/shared_rows.h"
#include "item3d/region/preview.h"
#include "item3d/render/image_tensor.h"
#include "item3d/report/animation.h"
#include "item3d/report/contact_sheet.h"
#include "item3d/report/display_image.h"
#include "item3d/report/model_images.h"

namespace item3d {
namespace {

constexpr int view_count = 6;
constexpr int turntable_frames = 30;
const Vec3 turntable_ground{0.898f, 0.890f, 0.871f};

std::vector<Image> to_images(const at::Tensor& linear) {
    std::vector<Image> images;
    for (const at::Tensor& image : linear.unbind(0)) {
        images.push_back(to_display(to_image(image)));
    }
    return images;
}

void save_sheet(const std::filesystem::path& path, const std::vector<Image>& images,
                const std::string& title) {
    std::vector<Tile> tiles;
    for (const Image& image : images)
        tiles.push_back({image, ""});
    ContactSheetOptions options;
    options.columns = 3;
    options.title = title;
    save_image(path, contact_sheet(tiles, options));
}

std::vector<ReportImage> to_report(const std::vector<Image>& displayed) {
    std::vector<ReportImage> images;
    for (const Image& image : displayed)
        images.push_back({"", encode_webp(image)});
    return images;
}

/// Calls ModelDrawing::draw() for a part of the views on each process, and gathers the images.
at::Tensor draw_together(const ProcessGroup& processes, const ModelDrawing& drawing,
                         const std::vector<Camera>& cameras, int pixels, at::Device device) {
    return compute_rows(processes, static_cast<std::int64_t>(cameras.size()), {pixels, pixels, 4},
                        device, [&](std::int64_t first, std::int64_t count) {
                            const auto begin = cameras.begin() + first;
                            return drawing.draw({begin, begin + count}, pixels);
                        });
}

at::Tensor images_before(const EditRequest& request, const EditScene& scene,
                         const EnvironmentLight& light, const std::vector<Camera>& cameras,
                         const std::optional<DrawnModel>& drawn) {
    const bool is_drawn = drawn && !scene.is_prepared && drawn->model == request.model &&
                          drawn->light == request.plan.light &&
                          drawn->pixels == request.image_pixels;
    return is_drawn ? drawn->images
                    : draw_together(request.processes, ModelDrawing(scene.model, light), cameras,
                                    request.image_pixels, scene.device);
}

/// Returns the turntable on the first process; an image without bytes on the others.
ReportImage draw_turntable(const EditRequest& request, const EditScene& scene,
                           const ModelDrawing& drawing) {
    const ProcessGroup& processes = request.processes;
    const auto cameras = image_cameras(scene.model, turntable_frames);
    std::vector<Image> frames;
    // Each batch has one frame per process, to keep memory low.
    for (auto next = cameras.begin(); next != cameras.end();) {
        const auto end = next + std::min<std::ptrdiff_t>(processes.size(), cameras.end() - next);
        const at::Tensor drawn = draw_together(processes, drawing, {next, end},
                                               request.image_pixels * 3 / 4, scene.device);
        next = end;
        if (!processes.first()) continue;
        for (const Image& frame : to_images(drawn))
            frames.push_back(flatten(frame, turntable_ground));
    }
    if (!processes.first()) return {};
    ReportImage image{request.plan.to, encode_animation(frames)};
    write_atomically(request.output / "turntable.webp", image.bytes);
    return image;
}

}  // namespace

EditImages render_images(const EditRequest& request, const EditScene& scene,
                         const EditedModel& edited, const Clip* clip, EditSession& session) {
    const int view_pixels = request.image_pixels;
    const int texels = light_texels(view_pixels);
    const EnvironmentLight light = prefilter(scene.lights->image(), texels, scene.device);
    const auto cameras = image_cameras(scene.model, view_count);
    const at::Tensor before = images_before(request, scene, light, cameras, session.drawn);
    const EnvironmentLight new_light =
        edited.light ? prefilter(*edited.light, texels, scene.device) : light;
    const ModelDrawing drawing(edited.model, new_light);
    const at::Tensor after =
        draw_together(request.processes, drawing, cameras, view_pixels, scene.device);
    std::optional<ReportImage> turntable;
    if (request.draws_turntable) turntable = draw_turntable(request, scene, drawing);
    if (!request.processes.first()) return {};
    session.drawn.reset();
    if (!edited.light && edited.is_as_read)
        session.drawn = {request.output / model_file_name(request.model), request.plan.light,
                         view_pixels, after};

    EditImages images;
    images.turntable = std::move(turntable);
    const auto before_images = to_images(before);
    const auto after_images = to_images(after);
    save_sheet(request.output / "before.png", before_images, request.plan.from);
    save_sheet(request.output / "after.png", after_images, request.plan.to);
    images.before = to_report(before_images);
    images.after = to_report(after_images);

    if (scene.region) {
        const std::vector<Image> region = region_images(
            *scene.region, scene.geometry, *scene.textured, light, cameras, view_pixels / 2);
        save_sheet(request.output / "region.png", region, "the region");
        images.region = to_report(region);
        images.outside = compare_outside(scene, edited.model);
    }

    const at::Tensor weights =
        scene.region ? mean_weights(*scene.region, scene.geometry, *scene.space) : at::Tensor();
    images.means_before = surface_means(scene.model, scene.materials, weights);
    images.means_after = surface_means(edited.model, scene.materials, weights);
    images.detail_kept = detail_kept(before, after);
    if (clip)
        images.clip = clip_scores(*clip, over_white(before), over_white(after), request.plan.from,
                                  request.plan.to);
    return images;
}

}  // namespace item3d
