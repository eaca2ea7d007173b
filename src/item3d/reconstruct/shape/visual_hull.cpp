#include "item3d/reconstruct/shape/visual_hull.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace item3d {

namespace {

constexpr float far_away = 1e12f;
constexpr int search_cells = 64;

/// Computes squared distances along one line: the lower envelope of parabolas with offsets `value`.
void distance_along(std::vector<float>& value, std::vector<int>& roots, std::vector<float>& ends,
                    std::vector<float>& result) {
    const int count = static_cast<int>(value.size());
    int last = 0;
    roots[0] = 0;
    ends[0] = -std::numeric_limits<float>::infinity();
    ends[1] = std::numeric_limits<float>::infinity();
    const auto meeting = [&](int p, int q) {
        const auto a = static_cast<float>(p), b = static_cast<float>(q);
        return ((value[q] + b * b) - (value[p] + a * a)) / (2 * (b - a));
    };
    for (int q = 1; q < count; ++q) {
        float at = meeting(roots[last], q);
        while (at <= ends[last])
            at = meeting(roots[--last], q);
        roots[++last] = q;
        ends[last] = at;
        ends[last + 1] = std::numeric_limits<float>::infinity();
    }
    for (int q = 0, k = 0; q < count; ++q) {
        while (ends[k + 1] < static_cast<float>(q))
            ++k;
        const auto step = static_cast<float>(q - roots[k]);
        result[q] = step * step + value[roots[k]];
    }
    value = result;
}

/// Returns the squared distance of each pixel to the nearest pixel whose mask equals `to`.
std::vector<float> squared_distance(const std::vector<bool>& mask, int width, int height, bool to) {
    std::vector<float> field(mask.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
        field[i] = mask[i] == to ? 0.0f : far_away;
    const auto lines = [&](int count, int length, std::size_t first_step, std::size_t step) {
        std::vector<float> value(length), result(length), ends(length + 1);
        std::vector<int> roots(length);
        for (int line = 0; line < count; ++line) {
            const std::size_t first = static_cast<std::size_t>(line) * first_step;
            for (int i = 0; i < length; ++i)
                value[i] = field[first + static_cast<std::size_t>(i) * step];
            distance_along(value, roots, ends, result);
            for (int i = 0; i < length; ++i)
                field[first + static_cast<std::size_t>(i) * step] = value[i];
        }
    };
    lines(width, height, 1, static_cast<std::size_t>(width));
    lines(height, width, static_cast<std::size_t>(width), 1);
    return field;
}

/// Interpolates the image bilinearly at pixel coordinates, which are clamped at the edges.
float look_up(const Image& image, float x, float y) {
    x = std::clamp(x - 0.5f, 0.0f, static_cast<float>(image.width - 1));
    y = std::clamp(y - 0.5f, 0.0f, static_cast<float>(image.height - 1));
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
    const float u = x - static_cast<float>(x0), v = y - static_cast<float>(y0);
    return std::lerp(std::lerp(image.at(x0, y0, 0), image.at(x1, y0, 0), u),
                     std::lerp(image.at(x0, y1, 0), image.at(x1, y1, 0), u), v);
}

}  // namespace

Image signed_distance(const Image& image) {
    std::vector<bool> mask;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            mask.push_back(image.at(x, y, image.channels - 1) >= 0.5f);
    const auto outside = squared_distance(mask, image.width, image.height, true);
    const auto inside = squared_distance(mask, image.width, image.height, false);
    // Limit of the distance, for masks that are full or empty.
    const auto limit = static_cast<float>(2 * std::max(image.width, image.height));
    Image result(image.width, image.height, 1);
    for (std::size_t i = 0; i < mask.size(); ++i)
        result.pixels[i] = mask[i] ? 0.5f - std::min(std::sqrt(inside[i]), limit)
                                   : std::min(std::sqrt(outside[i]), limit) - 0.5f;
    return result;
}

VisualHull::VisualHull(const std::vector<Photograph>& views) : silhouettes_(views.size()) {
    parallel_for(
        "signed_distance", static_cast<std::int64_t>(views.size()),
        [&](std::int64_t i) {
            const auto index = static_cast<std::size_t>(i);
            silhouettes_[index] = {views[index].camera, signed_distance(views[index].image)};
        },
        1);
}

at::Tensor VisualHull::distance(const at::Tensor& points_, std::size_t ignored) const {
    const at::Tensor points = points_.detach().contiguous();
    at::Tensor result = at::empty({points.size(0)});
    const float* p = points.const_data_ptr<float>();
    float* out = result.data_ptr<float>();
    struct Projection {
        Mat4 to_camera;
        float focal;
    };
    std::vector<Projection> projections;
    for (const Silhouette& silhouette : silhouettes_) {
        const float half = 0.5f * static_cast<float>(silhouette.distance.width);
        projections.push_back({silhouette.camera.world_to_camera(),
                               half / std::tan(0.5f * silhouette.camera.field_of_view_x)});
    }
    parallel_for(
        "visual_hull", points.size(0),
        [&](std::int64_t i) {
            const Vec4 point(p[3 * i], p[3 * i + 1], p[3 * i + 2], 1);
            std::vector<float> distances;
            for (std::size_t s = 0; s < silhouettes_.size(); ++s) {
                const Image& mask = silhouettes_[s].distance;
                const Vec3 seen(projections[s].to_camera * point);
                const float depth = -seen.z, focal = projections[s].focal;
                if (depth <= 1e-6f) continue;
                const float x = focal * seen.x / depth + 0.5f * static_cast<float>(mask.width);
                const float y = -focal * seen.y / depth + 0.5f * static_cast<float>(mask.height);
                if (x < 0 || y < 0 || x > static_cast<float>(mask.width) ||
                    y > static_cast<float>(mask.height))
                    continue;
                distances.push_back(look_up(mask, x, y) * depth / focal);
            }
            if (distances.empty()) {
                out[i] = far_away;
                return;
            }
            const auto chosen = distances.begin() + static_cast<std::ptrdiff_t>(
                                                        std::min(ignored, distances.size() - 1));
            std::nth_element(distances.begin(), chosen, distances.end(), std::greater<>());
            out[i] = *chosen;
        },
        1024);
    return result;
}

std::array<Vec3, 2> VisualHull::bounds(Vec3 centre, float radius, const std::string& subject,
                                       std::size_t ignored) const {
    const float reach = 1.2f * radius;
    const Lattice lattice{
        centre - reach, 2 * reach / search_cells, {search_cells, search_cells, search_cells}};
    const at::Tensor points = lattice.vertices();
    // Thin parts may lie between the lattice's points, so points within a cell of the hull count
    // too.
    const at::Tensor inside = (distance(points, ignored) < lattice.cell).nonzero().select(1, 0);
    if (inside.size(0) == 0) {
        throw InputError(
            subject, "no point is inside the masks of all views",
            "check that the object is in all images, and that poses and masks belong together");
    }
    const at::Tensor found = points.index_select(0, inside);
    const at::Tensor low = std::get<0>(found.min(0)), high = std::get<0>(found.max(0));
    const auto corner = [](const at::Tensor& t) {
        return Vec3(t[0].item<float>(), t[1].item<float>(), t[2].item<float>());
    };
    return {corner(low) - lattice.cell, corner(high) + lattice.cell};
}

double VisualHull::disagreement(const std::vector<Photograph>& views, Vec3 centre,
                                float radius) const {
    constexpr int pixels_a_view = 64;
    double sum = 0, count = 0;
    for (const Photograph& view : views) {
        const Image& image = view.image;
        std::vector<Vec2> inside;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                if (image.at(x, y, 3) > 0.99f) inside.emplace_back(x + 0.5f, y + 0.5f);
        if (inside.empty()) continue;
        const float slope = std::tan(0.5f * view.camera.field_of_view_x);
        const Mat4& pose = view.camera.camera_to_world;
        const Vec3 eye = view.camera.position();
        const float distance = glm::distance(eye, centre);
        const float pixel = 2 * slope * distance / static_cast<float>(image.width);
        const int steps = static_cast<int>(std::ceil(2 * radius / (0.5f * pixel)));
        const std::size_t every = std::max<std::size_t>(1, inside.size() / pixels_a_view);
        std::vector<float> points;
        for (std::size_t i = every / 2; i < inside.size(); i += every) {
            const Vec2 p = 2.0f * inside[i] / static_cast<float>(image.width);
            const float aspect = static_cast<float>(image.height) / static_cast<float>(image.width);
            const Vec3 ray = Vec3(pose * Vec4((p.x - 1) * slope, (aspect - p.y) * slope, -1, 0));
            for (int k = 0; k < steps; ++k) {
                const float depth =
                    distance - radius + 0.5f * pixel * (static_cast<float>(k) + 0.5f);
                const Vec3 point = eye + depth * ray;
                points.insert(points.end(), {point.x, point.y, point.z});
            }
        }
        const auto rays = static_cast<std::int64_t>(points.size()) / (3 * steps);
        const at::Tensor places = at::from_blob(points.data(), {rays * steps, 3}, at::kFloat);
        const at::Tensor nearest =
            std::get<0>(this->distance(places).reshape({rays, steps}).min(1));
        sum += (nearest.clamp_min(0) / pixel).sum().item<double>();
        count += static_cast<double>(rays);
    }
    return count > 0 ? sum / count : 0;
}

Lattice make_lattice(std::array<Vec3, 2> bounds, int cells) {
    const Vec3 size = bounds[1] - bounds[0];
    Lattice lattice;
    lattice.cell = std::max({size.x, size.y, size.z, 1e-6f}) / static_cast<float>(cells - 2);
    const Vec3 middle = 0.5f * (bounds[0] + bounds[1]);
    for (int a = 0; a < 3; ++a) {
        lattice.cells[a] = std::max(2, static_cast<int>(std::ceil(size[a] / lattice.cell)) + 2);
        lattice.origin[a] = middle[a] - 0.5f * lattice.cell * static_cast<float>(lattice.cells[a]);
    }
    return lattice;
}

}  // namespace item3d
