#include "item3d/prior/data/views.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/prior/data/shapes/polygonize.h"
#include "item3d/prior/data/shapes/shapes.h"
#include "item3d/prior/data/sky_visibility.h"
#include "item3d/render/interpolate.h"
#include "item3d/render/rasterize.h"
#include "item3d/render/scatter.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/workers.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

namespace item3d {
namespace {

/// Fraction of the views that show only a part of the object. Its material then covers more pixels.
constexpr double close_up_share = .2;

struct ViewCamera {
    Camera camera;
    bool close_up;
};

/// Returns a camera in a random direction, at a distance at which the mesh fills a random part of
/// the image. This part is large, because the autoencoder loses the material of small objects.
ViewCamera random_camera(Random& random, const std::vector<Vec3>& positions) {
    const auto azimuth = static_cast<float>(random.uniform(0, 2 * pi));
    const auto elevation = static_cast<float>(glm::radians(random.uniform(-10, 50)));
    const auto fov = static_cast<float>(glm::radians(random.uniform(25, 45)));
    const bool close_up = random.chance(close_up_share);
    const auto fill =
        static_cast<float>(close_up ? random.uniform(1.1, 1.6) : random.uniform(.7, .95));
    const Mat4 to_camera = orbit_camera(Vec3(0.0f), 1, azimuth, elevation, fov).world_to_camera();
    const float tangent = std::tan(fov / 2);
    std::vector<Vec3> seen;  // relative to a camera at distance 1 from the origin
    Vec3 lowest(std::numeric_limits<float>::max()), highest(-lowest);
    // One vertex in seven suffices for the outline.
    for (std::size_t i = 0; i < positions.size(); i += 7) {
        seen.emplace_back(to_camera * Vec4(positions[i], 1));
        lowest = glm::min(lowest, seen.back());
        highest = glm::max(highest, seen.back());
    }
    const Vec3 middle = (lowest + highest) / 2.0f;
    float distance = 0;
    for (const Vec3& p : seen) {
        const float aside = std::max(std::abs(p.x - middle.x), std::abs(p.y - middle.y));
        distance = std::max(distance, p.z + 1 + aside / (tangent * fill));
    }
    Camera camera = orbit_camera(Vec3(0.0f), distance, azimuth, elevation, fov);
    // The shape is offset from the middle by a fraction of the free margin or, in a close-up, of
    // the width beyond the image's edge.
    const float margin = std::abs(1 - fill) * tangent * distance * .7f;
    const float dx = middle.x + static_cast<float>(random.uniform(-margin, margin));
    const float dy = middle.y + static_cast<float>(random.uniform(-margin, margin));
    camera.camera_to_world[3] += camera.camera_to_world[0] * dx + camera.camera_to_world[1] * dy;
    return {camera, close_up};
}

Geometry to_geometry(const Primitive& primitive) {
    Model model;
    model.primitives.push_back(primitive);
    model.materials.emplace_back();
    return Geometry::from_model(model);
}

std::int16_t pack(float value) {
    return static_cast<std::int16_t>(std::lround(std::clamp(value, -1.0f, 1.0f) * 32767.0f));
}

}  // namespace

std::vector<ShapeView> make_views(const std::string& shape_class, int variant, int count,
                                  std::uint64_t seed, int resolution, int image) {
    const at::NoGradGuard no_grad;
    const Shape shape = make_shape(shape_class, variant);
    const Polygonized mesh =
        polygonize([&](const Vec3& p) { return shape.distance(p); }, resolution);
    const Geometry geometry = to_geometry(mesh.primitive);
    const int size = image * view_samples;
    // ShapeView::pixel has 16 bits.
    ITEM3D_CHECK(size <= 256, "views are at most 256 pixels wide");

    const int index = shape_class_index(shape_class);
    Random random(seed, static_cast<std::uint64_t>(index * 1000 + variant));
    std::vector<Camera> cameras;
    std::vector<ShapeView> views(static_cast<std::size_t>(count));
    for (ShapeView& view : views) {
        const auto [camera, close_up] = random_camera(random, mesh.primitive.positions);
        cameras.push_back(camera);
        view.close_up = close_up;
    }
    const Raster raster = rasterize(geometry, cameras, size, size);
    const Surface surface = interpolate_surface(geometry, raster, cameras);
    const auto image_of = [&](const at::Tensor& values) {
        return scatter(values, surface, raster, at::zeros({3}));
    };
    const SeenShape seen{raster.depth, image_of(surface.position), image_of(surface.normal)};
    const at::Tensor cells = shape_cells(seen, size / latent_size);  // [N, 7, h, w]

    for (std::size_t i = 0; i < views.size(); ++i) {
        views[i].shape_class = index;
        views[i].variant = variant;
        views[i].size = size;
        views[i].camera = cameras[i].position();
        for (const ShapePart& part : shape.parts)
            views[i].parts.push_back(part.noun);
        views[i].cells = cells[static_cast<std::int64_t>(i)].to(at::kHalf).contiguous();
    }
    SkyVisibility sky(geometry);
    const at::Tensor pixels = surface.pixel.contiguous();
    const at::Tensor positions = surface.position.contiguous();
    const at::Tensor normals = surface.normal.contiguous();
    const auto* pixel = pixels.data_ptr<std::int64_t>();
    const auto* position = positions.data_ptr<float>();
    const auto* normal = normals.data_ptr<float>();
    const std::int64_t area = std::int64_t{size} * size;
    for (std::int64_t i = 0; i < surface.count(); ++i) {
        ShapeView& view = views[static_cast<std::size_t>(pixel[i] / area)];
        const Vec3 p(position[3 * i], position[3 * i + 1], position[3 * i + 2]);
        const Vec3 n(normal[3 * i], normal[3 * i + 1], normal[3 * i + 2]);
        view.pixel.push_back(static_cast<std::uint16_t>(pixel[i] % area));
        for (int c = 0; c < 3; ++c) {
            view.position.push_back(pack(p[c]));
            view.normal.push_back(pack(n[c]));
        }
        view.part.push_back(static_cast<std::uint8_t>(shape.part_at(p * mesh.scale + mesh.center)));
        view.sky.push_back(sky.at(p, n));
    }
    for (ShapeView& view : views) {
        view.pixel.shrink_to_fit();
        view.position.shrink_to_fit();
        view.normal.shrink_to_fit();
        view.part.shrink_to_fit();
        view.sky.shrink_to_fit();
    }
    return views;
}

std::vector<ShapeView> make_view_pool(bool held_out, int variants, int views_each,
                                      std::uint64_t seed, int threads, int image) {
    struct Job {
        std::string shape_class;
        int variant;
    };
    std::vector<Job> jobs;
    for (const ShapeClass& each : shape_classes()) {
        for (const int variant : shape_variants_of(each, held_out, variants))
            jobs.push_back({each.name, variant});
    }
    std::vector<std::vector<ShapeView>> made(jobs.size());
    std::atomic<std::int64_t> done = 0;
    std::mutex mutex;
    Progress progress(held_out ? "held-out shapes" : "shapes",
                      static_cast<std::int64_t>(jobs.size()));
    run_workers(static_cast<std::int64_t>(jobs.size()), threads, [&](std::int64_t i) {
        const Job& job = jobs[static_cast<std::size_t>(i)];
        made[static_cast<std::size_t>(i)] =
            make_views(job.shape_class, job.variant, views_each, seed, 96, image);
        const std::lock_guard lock(mutex);
        progress.update(++done);
    });
    std::vector<ShapeView> pool;
    for (std::vector<ShapeView>& views : made)
        for (ShapeView& view : views)
            pool.push_back(std::move(view));
    return pool;
}

}  // namespace item3d
