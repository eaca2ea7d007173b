#include "item3d/reconstruct/dataset/outline_overlap.h"

#include "item3d/reconstruct/shape/visual_hull.h"
#include "item3d/render/rasterize.h"
#include "item3d/report/display_image.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

constexpr float agreeing_pixels = 1.6f;

Vec3 corner_in(const at::Tensor& row) {
    return {row[0].item<float>(), row[1].item<float>(), row[2].item<float>()};
}

}  // namespace

Image compared_mask(const Image& image, double side) {
    Image mask(image.width, image.height, 1);
    double covered = 0;
    for (std::size_t i = 0; i < mask.pixels.size(); ++i) {
        mask.pixels[i] = image.pixels[(i + 1) * static_cast<std::size_t>(image.channels) - 1];
        covered += mask.pixels[i];
    }
    const int shrink = std::max(1, static_cast<int>(std::sqrt(covered) / side));
    return resize(mask, std::max(1, image.width / shrink), std::max(1, image.height / shrink));
}

OutlineViews::OutlineViews(const TriangleMesh& mesh, const std::vector<Photograph>& views,
                           double side) {
    geometry_.positions = mesh.positions.detach().contiguous();
    geometry_.triangles = mesh.triangles.to(at::kInt).contiguous();
    bounds_ = {corner_in(std::get<0>(geometry_.positions.min(0))),
               corner_in(std::get<0>(geometry_.positions.max(0)))};
    for (const Photograph& view : views) {
        Image mask = compared_mask(view.image, side);
        Image distance = signed_distance(mask);
        views_.push_back({view.camera, std::move(mask), std::move(distance)});
    }
}

OutlineOverlap OutlineViews::compare(const Placement& placement, bool with_agreement) const {
    double both = 0, drawn_pixels = 0, mask_pixels = 0, right = 0;
    for (const View& view : views_) {
        // The inverse motion of the camera gives the same image as the motion of the mesh.
        Camera camera = view.camera;
        const Mat3 back = glm::transpose(placement.turn);
        const Vec3 eye = back * (camera.position() - placement.move) / placement.scale;
        camera.camera_to_world = Mat4(back) * camera.camera_to_world;
        camera.camera_to_world[3] = Vec4(eye, 1);
        fit_depth_range(camera, bounds_);
        const Raster raster = rasterize(geometry_, {camera}, view.mask.width, view.mask.height);
        const std::int32_t* triangle = raster.triangle.const_data_ptr<std::int32_t>();
        Image drawn(view.mask.width, view.mask.height, 1);
        for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
            const bool in_drawn = triangle[i] >= 0, in_mask = view.mask.pixels[i] >= 0.5f;
            drawn.pixels[i] = in_drawn ? 1.0f : 0.0f;
            both += in_drawn && in_mask;
            drawn_pixels += in_drawn;
            mask_pixels += in_mask;
        }
        if (!with_agreement) continue;
        const Image distance = signed_distance(drawn);
        for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
            right += drawn.pixels[i] >= 0.5f && view.distance.pixels[i] < agreeing_pixels;
            right += view.mask.pixels[i] >= 0.5f && distance.pixels[i] < agreeing_pixels;
        }
    }
    OutlineOverlap overlap;
    overlap.iou = both > 0 ? both / (drawn_pixels + mask_pixels - both) : 0.0;
    overlap.agreement = right > 0 ? right / (drawn_pixels + mask_pixels) : 0.0;
    overlap.masks_covered = both > 0 ? both / mask_pixels : 0.0;
    return overlap;
}

}  // namespace item3d
