#include "item3d/reconstruct/dataset/check_frame.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/reconstruct/shape/visual_hull.h"
#include "item3d/render/rasterize.h"
#include "item3d/report/picture.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace item3d {

namespace {

constexpr std::size_t frame_views = 8, hull_views = 24;
/// Pictures are shrunk until the object has about as many pixels as a square of this side.
constexpr double compared_side = 60;
constexpr double least_overlap = 0.8, least_agreement = 0.95;
/// A turn must be better by this much than what is there.
constexpr double plainly_better = 0.1;
/// Least parts, of the masks and of the overlap, of a mesh whose opacity cuts out the rest.
constexpr double least_masks_covered = 0.985, least_overlap_of_cut_out = 0.5;
/// An overlap from which on a placement is not looked for more closely.
constexpr double well_placed = 0.97;
/// Turns that are no better than this are as good as each other: the first is the simplest.
constexpr double overlap_noise = 0.005;
constexpr float agreeing_pixels = 1.6f;

/// A turn about the origin, in words.
struct NamedTurn {
    Mat3 matrix;
    std::string words;
};

/// All that bring axes to axes: one turn about x, y or z, or two one after the other.
std::vector<NamedTurn> axis_turns() {
    std::vector<NamedTurn> single;
    for (const int degrees : {90, -90, 180}) {
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 about(0.0f);
            about[axis] = 1;
            Mat3 matrix(glm::rotate(Mat4(1.0f), glm::radians(static_cast<float>(degrees)), about));
            for (int c = 0; c < 3; ++c)
                matrix[c] = glm::round(matrix[c]);
            single.push_back({matrix, fmt::format("{} degrees about {}", degrees, "xyz"[axis])});
        }
    }
    std::vector<NamedTurn> turns{{Mat3(1.0f), ""}};
    const auto add = [&](const NamedTurn& turn) {
        if (std::none_of(turns.begin(), turns.end(),
                         [&](const NamedTurn& t) { return t.matrix == turn.matrix; }))
            turns.push_back(turn);
    };
    for (const NamedTurn& turn : single)
        add(turn);
    for (const NamedTurn& first : single)
        for (const NamedTurn& second : single)
            add({second.matrix * first.matrix, first.words + ", then " + second.words});
    return turns;
}

/// Axis turns, and the dataset's own world where that is another one.
std::vector<NamedTurn> turns_to_try(const Mat3& world_from_dataset) {
    std::vector<NamedTurn> turns = axis_turns();
    const auto near = [&](const NamedTurn& turn) {
        float apart = 0;
        for (int c = 0; c < 3; ++c)
            apart += glm::length(turn.matrix[c] - world_from_dataset[c]);
        return apart < 1e-3f;
    };
    if (std::none_of(turns.begin(), turns.end(), near)) {
        const Mat3& m = world_from_dataset;
        const Vec3 twice(m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]);
        const float angle = std::atan2(glm::length(twice), m[0][0] + m[1][1] + m[2][2] - 1);
        const Vec3 axis = glm::length(twice) > 1e-6f ? glm::normalize(twice) : Vec3(0.0f);
        turns.push_back(
            {m, fmt::format("{:.1f} degrees about ({:.3f}, {:.3f}, {:.3f}), as the dataset's world "
                            "is here",
                            glm::degrees(angle), axis.x, axis.y, axis.z)});
    }
    return turns;
}

struct OutlineOverlap {
    double iou = 0, agreement = 0, masks_covered = 0;
};

/// Draws a mesh's outline and compares.
class FrameViews {
  public:
    FrameViews(const TriangleMesh& mesh, const std::vector<Photograph>& views);

    OutlineOverlap compare(const Placement& placement, bool with_agreement = false) const;
    const std::array<Vec3, 2>& mesh_bounds() const { return bounds_; }

  private:
    struct View {
        Camera camera;
        Image mask, distance;
    };
    Geometry geometry_;
    std::array<Vec3, 2> bounds_;
    std::vector<View> views_;
};

Vec3 corner_of(const at::Tensor& row) {
    return {row[0].item<float>(), row[1].item<float>(), row[2].item<float>()};
}

/// Coverage alone, of such a size that the object has enough pixels to be compared.
Image compared_mask(const Image& image) {
    Image mask(image.width, image.height, 1);
    double covered = 0;
    for (std::size_t i = 0; i < mask.pixels.size(); ++i) {
        mask.pixels[i] = image.pixels[(i + 1) * static_cast<std::size_t>(image.channels) - 1];
        covered += mask.pixels[i];
    }
    const int shrink = std::max(1, static_cast<int>(std::sqrt(covered) / compared_side));
    return resize(mask, std::max(1, image.width / shrink), std::max(1, image.height / shrink));
}

FrameViews::FrameViews(const TriangleMesh& mesh, const std::vector<Photograph>& views) {
    geometry_.positions = mesh.positions.detach().contiguous();
    geometry_.triangles = mesh.triangles.to(at::kInt).contiguous();
    bounds_ = {corner_of(std::get<0>(geometry_.positions.min(0))),
               corner_of(std::get<0>(geometry_.positions.max(0)))};
    for (const Photograph& view : some_views(views, frame_views)) {
        Image mask = compared_mask(view.image);
        Image distance = signed_distance(mask);
        views_.push_back({view.camera, std::move(mask), std::move(distance)});
    }
}

OutlineOverlap FrameViews::compare(const Placement& placement, bool with_agreement) const {
    double both = 0, drawn_pixels = 0, mask_pixels = 0, right = 0;
    for (const View& view : views_) {
        // The camera is placed the other way instead of the mesh: the picture is the same.
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

/// The box of what the masks of some views allow, as near as it can be told at once.
std::array<Vec3, 2> hull_box(const Dataset& dataset) {
    std::vector<Photograph> views = some_views(dataset.train, hull_views);
    for (Photograph& view : views)
        view.image = compared_mask(view.image);
    const VisualHull hull(views);
    const Lattice lattice = make_lattice(hull.bounds(dataset.centre, dataset.radius, "hull"), 48);
    const at::Tensor points = lattice.vertices();
    const at::Tensor distances = hull.distance(points);
    const at::Tensor inside = (distances < 0).nonzero().select(1, 0);
    if (inside.size(0) == 0) throw InputError("hull", "is empty");
    const at::Tensor found = points.index_select(0, inside);
    return {corner_of(std::get<0>(found.min(0))) - 0.5f * lattice.cell,
            corner_of(std::get<0>(found.max(0))) + 0.5f * lattice.cell};
}

/// Steps in scale and place, for as long as they help, then steps of half the length.
void improve_placement(const FrameViews& views, float size, Placement& placement) {
    constexpr int most_rounds = 3;
    const Vec3 middle = 0.5f * (views.mesh_bounds()[0] + views.mesh_bounds()[1]);
    for (float step = 0.08f; step > 0.008f; step *= 0.5f) {
        bool is_better = true;
        for (int round = 0; round < most_rounds && is_better; ++round) {
            is_better = false;
            for (int way = 0; way < 8; ++way) {
                Placement tried = placement;
                const float signed_step = way % 2 == 0 ? step : -step;
                if (way < 6) {
                    tried.move[way / 2] += signed_step * size;
                } else {  // the middle stays
                    tried.scale *= 1 + signed_step;
                    tried.move += (placement.scale - tried.scale) * (placement.turn * middle);
                }
                tried.overlap = views.compare(tried).iou;
                if (tried.overlap <= placement.overlap) continue;
                placement = tried;
                is_better = true;
            }
        }
        if (placement.overlap > well_placed) return;
    }
}

/// With the box's middle in the hull's, and of its size.
Placement placed_in_hull(const FrameViews& views, const Dataset& dataset,
                         const std::vector<NamedTurn>& turns) {
    constexpr std::size_t improved = 3;
    std::array<Vec3, 2> box;
    try {
        box = hull_box(dataset);
    } catch (const InputError&) {  // masks that do not belong together are another check's
        return {};
    }
    const Vec3 mesh_size = views.mesh_bounds()[1] - views.mesh_bounds()[0];
    const Vec3 middle = 0.5f * (views.mesh_bounds()[0] + views.mesh_bounds()[1]);
    const Vec3 hull_size = box[1] - box[0], hull_middle = 0.5f * (box[0] + box[1]);
    const float size = std::max({hull_size.x, hull_size.y, hull_size.z});
    const float thinnest = 1e-6f * std::max({mesh_size.x, mesh_size.y, mesh_size.z, 1e-20f});
    std::vector<Placement> placements;
    for (const NamedTurn& turn : turns) {
        Placement placement{turn.matrix, std::numeric_limits<float>::max(), Vec3(0.0f), turn.words,
                            0};
        // The hull is never smaller than the object: the tightest axis tells the size.
        const Vec3 turned_size = glm::abs(turn.matrix * mesh_size);
        for (int a = 0; a < 3; ++a)
            placement.scale =
                std::min(placement.scale, hull_size[a] / std::max(turned_size[a], thinnest));
        placement.move = hull_middle - placement.scale * (turn.matrix * middle);
        placement.overlap = views.compare(placement).iou;
        placements.push_back(placement);
    }
    std::stable_sort(placements.begin(), placements.end(),
                     [](const auto& a, const auto& b) { return a.overlap > b.overlap; });
    placements.resize(std::min(improved, placements.size()));
    Placement best;
    for (Placement& placement : placements) {
        improve_placement(views, size, placement);
        if (placement.overlap > best.overlap + overlap_noise) best = placement;
        if (best.overlap > well_placed) break;
    }
    std::string& words = best.words;
    if (!words.empty()) words = "turned by " + words;
    if (std::abs(best.scale - 1) > 0.02f)
        words += fmt::format("{}scaled by {:.3g}", words.empty() ? "" : ", ", best.scale);
    if (glm::length(best.move) > 0.02f * size) {
        words += fmt::format("{}moved by ({:.3g}, {:.3g}, {:.3g})", words.empty() ? "" : ", then ",
                             best.move.x, best.move.y, best.move.z);
    }
    return best;
}

bool may_be_cut_out(const OutlineOverlap& overlap) {
    return overlap.iou >= least_overlap_of_cut_out && overlap.masks_covered >= least_masks_covered;
}

/// Whether the best placement is worth being told.
bool is_told_by(const FrameViews& views, const FrameFit& fit) {
    if (fit.best.overlap < fit.overlap + plainly_better) return false;
    return fit.best.overlap >= least_overlap || may_be_cut_out(views.compare(fit.best));
}

}  // namespace

FrameFit fit_frame(const TriangleMesh& mesh, const Dataset& dataset) {
    const at::NoGradGuard no_gradient;
    const FrameViews views(mesh, dataset.train);
    const OutlineOverlap now = views.compare({}, true);
    FrameFit fit;
    fit.overlap = now.iou;
    fit.agreement = now.agreement;
    fit.masks_covered = now.masks_covered;
    fit.may_be_cut_out = may_be_cut_out(now);
    fit.best.overlap = now.iou;
    fit.fits = now.iou >= least_overlap || now.agreement >= least_agreement;
    if (fit.fits) return fit;
    const std::vector<NamedTurn> turns = turns_to_try(dataset.world_from_dataset);
    for (const NamedTurn& turn : turns) {
        Placement placement{turn.matrix, 1, Vec3(0.0f), "", 0};
        placement.overlap = views.compare(placement).iou;
        if (placement.overlap <= fit.best.overlap + overlap_noise) continue;
        placement.words = "turned by " + turn.words;
        fit.best = placement;
    }
    fit.best_fits = is_told_by(views, fit);
    // A mesh that hides all of the masks where it is may be right: it is not placed elsewhere.
    if (fit.best_fits || may_be_cut_out(now)) return fit;
    const Placement placed = placed_in_hull(views, dataset, turns);
    if (placed.overlap <= fit.best.overlap + plainly_better) return fit;
    fit.best = placed;
    fit.best_fits = is_told_by(views, fit);
    return fit;
}

std::string check_mesh_frame(const TriangleMesh& mesh, const Dataset& dataset,
                             const std::string& file) {
    const FrameFit fit = fit_frame(mesh, dataset);
    if (fit.fits) return {};
    const std::string problem =
        fmt::format("the mesh's outlines overlap the masks by {:.0f} %", 100 * fit.overlap);
    if (fit.best_fits) {
        throw InputError(
            file, problem,
            fmt::format("{} they overlap by {:.0f} %: {}", fit.best.words, 100 * fit.best.overlap,
                        fit.best.scale == 1 && fit.best.move == Vec3(0.0f) ? "turn the mesh"
                                                                           : "place the mesh so"));
    }
    if (!fit.may_be_cut_out) {
        throw InputError(file, problem,
                         "none of the 24 axis turns fits: give the mesh in the photographs' world "
                         "(see world_from_dataset in docs/reconstruct.md)");
    }
    return file + ": " + problem + ": it is larger than what they show";
}

}  // namespace item3d
