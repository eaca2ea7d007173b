#include "item3d/reconstruct/dataset/check_frame.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/reconstruct/dataset/outline_overlap.h"
#include "item3d/reconstruct/shape/visual_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace item3d {

namespace {

constexpr std::size_t frame_views = 8, hull_views = 24, refining_views = 12;
constexpr double compared_side = 60, refining_side = 200;
constexpr double min_overlap = 0.8, min_agreement = 0.95;
/// Minimum improvement of the overlap by a placement.
constexpr double plainly_better = 0.1;
/// Minimum fraction of the masks that a mesh must cover, and its minimum overlap, if its opacity
/// may cut out the parts outside the masks.
constexpr double min_masks_covered = 0.985, min_overlap_of_cut_out = 0.5;
/// Overlap above which a placement is not refined.
constexpr double well_placed = 0.97;
/// Minimum overlap for accepting a scale factor between units. A mesh in another unit reaches it,
/// and hardly any other mesh does.
constexpr double overlap_of_unit = 0.9;
/// Placements are equally good if their overlaps differ by less than this. The first of equally
/// good placements is kept, because its rotation is the simplest.
constexpr double overlap_noise = 0.005;
/// Minimum gain in overlap for which a placement with a move replaces one without.
constexpr double worth_a_move = 0.03;

struct Box {
    Vec3 low, high;
    Vec3 middle() const { return 0.5f * (low + high); }
    Vec3 size() const { return high - low; }
    float longest() const { return std::max({size().x, size().y, size().z}); }
};

/// Returns the box of the largest connected part with negative values. Other parts are small
/// remains in regions that few images show.
std::optional<Box> largest_part(const Lattice& lattice, const float* values) {
    const std::array<std::int64_t, 3> count{lattice.cells[0] + 1, lattice.cells[1] + 1,
                                            lattice.cells[2] + 1};
    const std::array<std::int64_t, 3> stride{1, count[0], count[0] * count[1]};
    std::vector<bool> seen(static_cast<std::size_t>(lattice.vertex_count()));
    std::vector<std::int64_t> part;
    std::optional<Box> box;
    std::size_t maximum = 0;
    for (std::int64_t first = 0; first < lattice.vertex_count(); ++first) {
        part.assign(1, first);
        Box around{Vec3(std::numeric_limits<float>::max()),
                   Vec3(std::numeric_limits<float>::lowest())};
        const auto visit = [&](std::int64_t vertex) {
            if (values[vertex] >= 0 || seen[static_cast<std::size_t>(vertex)]) return false;
            seen[static_cast<std::size_t>(vertex)] = true;
            return true;
        };
        if (!visit(first)) continue;
        for (std::size_t next = 0; next < part.size(); ++next) {
            Vec3 at;
            for (std::size_t a = 0; a < 3; ++a) {
                const std::int64_t place = part[next] / stride[a] % count[a];
                at[static_cast<int>(a)] = static_cast<float>(place);
                if (place > 0 && visit(part[next] - stride[a]))
                    part.push_back(part[next] - stride[a]);
                if (place + 1 < count[a] && visit(part[next] + stride[a]))
                    part.push_back(part[next] + stride[a]);
            }
            around = {glm::min(around.low, at), glm::max(around.high, at)};
        }
        if (part.size() <= maximum) continue;
        maximum = part.size();
        box = Box{lattice.origin + lattice.cell * around.low,
                  lattice.origin + lattice.cell * around.high};
    }
    return box;
}

/// Returns an approximate box of the visual hull of some views' masks.
std::optional<Box> hull_box(const Dataset& dataset) {
    std::vector<Photograph> views = some_views(dataset.train, hull_views);
    for (Photograph& view : views)
        view.image = compared_mask(view.image, compared_side);
    const VisualHull hull(views);
    try {
        const Lattice lattice =
            make_lattice(hull.bounds(dataset.centre, dataset.radius, "hull"), 48);
        const at::Tensor distances = hull.distance(lattice.vertices()).contiguous();
        std::optional<Box> box = largest_part(lattice, distances.const_data_ptr<float>());
        if (!box) return std::nullopt;
        return Box{box->low - 0.5f * lattice.cell, box->high + 0.5f * lattice.cell};
    } catch (const InputError&) {  // another check reports inconsistent masks
        return std::nullopt;
    }
}

/// Improves the scale and, if `moves`, the position by steps that increase the overlap. The step
/// length is halved from `first` down to `last`. middle: centre of the mesh's box.
void improve_placement(const OutlineViews& views, Vec3 middle, float size, float first, float last,
                       bool moves, double good_enough, Placement& placement) {
    constexpr int max_rounds = 3;
    for (float step = first; step > last; step *= 0.5f) {
        bool is_better = true;
        for (int round = 0; round < max_rounds && is_better; ++round) {
            is_better = false;
            for (int way = moves ? 0 : 6; way < 8; ++way) {
                Placement tried = placement;
                const float signed_step = way % 2 == 0 ? step : -step;
                if (way < 6) {
                    tried.move[way / 2] += signed_step * size;
                } else {
                    tried.scale *= 1 + signed_step;
                    if (moves)  // keeps the middle in place
                        tried.move += (placement.scale - tried.scale) * (placement.turn * middle);
                }
                tried.overlap = views.compare(tried).iou;
                if (tried.overlap <= placement.overlap) continue;
                placement = tried;
                is_better = true;
            }
        }
        if (placement.overlap > good_enough) return;
    }
}

/// Search for the unit and the position of a mesh in a visual hull.
class PlacementSearch {
  public:
    PlacementSearch(const OutlineViews& views, const std::vector<NamedTurn>& turns, Box hull)
        : views_(views),
          turns_(turns),
          hull_(hull),
          mesh_{views.mesh_bounds()[0], views.mesh_bounds()[1]} {}

    /// Returns the best placement by a rotation and a scale factor between two units, about the
    /// origin.
    Placement unit() const {
        Placement best;
        for (const NamedTurn& turn : turns_)
            for (const NamedScale& scale : scales_near(tightest_scale(turn)))
                try_scale(turn, scale.factor, scale.words, best);
        return best;
    }

    /// Returns the best placement by a rotation and any scale factor, about the origin.
    Placement scale() const {
        std::vector<Placement> all;
        for (const NamedTurn& turn : turns_) {
            Placement placement;
            try_scale(turn, tightest_scale(turn), "", placement);
            placement.words = turn.words;
            all.push_back(placement);
        }
        return improved(std::move(all), false);
    }

    /// Returns the best placement that starts with the mesh's box scaled to the hull's box and
    /// moved to its middle.
    Placement place() const {
        std::vector<Placement> all;
        for (const NamedTurn& turn : turns_) {
            Placement placement{turn.matrix, tightest_scale(turn), Vec3(0.0f), turn.words, 0};
            placement.move = hull_.middle() - placement.scale * (turn.matrix * mesh_.middle());
            placement.overlap = views_.compare(placement).iou;
            all.push_back(placement);
        }
        return improved(std::move(all), true);
    }

  private:
    /// Returns the largest scale at which the mesh's box fits into the hull's box. The hull is
    /// never smaller than the object.
    float tightest_scale(const NamedTurn& turn) const {
        const float thinnest = 1e-6f * std::max(mesh_.longest(), 1e-20f);
        const Vec3 turned = glm::abs(turn.matrix * mesh_.size());
        float scale = std::numeric_limits<float>::max();
        for (int a = 0; a < 3; ++a)
            scale = std::min(scale, hull_.size()[a] / std::max(turned[a], thinnest));
        return scale;
    }

    void try_scale(const NamedTurn& turn, float factor, const std::string& words,
                   Placement& best) const {
        Placement placement{turn.matrix, factor, Vec3(0.0f), "", 0};
        placement.overlap = views_.compare(placement).iou;
        if (placement.overlap <= best.overlap + overlap_noise) return;
        placement.words = placement_words(placement, turn.words, words, hull_.longest());
        best = placement;
    }

    static void keep_best(std::vector<Placement>& all, std::size_t count) {
        std::stable_sort(all.begin(), all.end(),
                         [](const auto& a, const auto& b) { return a.overlap > b.overlap; });
        all.resize(std::min(count, all.size()));
    }

    void improve(Placement& placement, float first, float last, bool moves) const {
        improve_placement(views_, mesh_.middle(), hull_.longest(), first, last, moves, well_placed,
                          placement);
    }

    /// Refines a few of the best placements and returns the best result. all: placements whose
    /// `words` describe the rotation only.
    Placement improved(std::vector<Placement> all, bool moves) const {
        constexpr std::size_t tried = 8, looked_at = 3;
        keep_best(all, tried);
        for (Placement& placement : all)
            improve(placement, 0.08f, 0.07f, moves);
        keep_best(all, looked_at);
        Placement best;
        for (Placement& placement : all) {
            improve(placement, 0.04f, 0.008f, moves);
            if (placement.overlap > best.overlap + overlap_noise) best = placement;
            if (best.overlap > well_placed) break;
        }
        best.words =
            placement_words(best, best.words, fmt::format("{:.3g}", best.scale), hull_.longest());
        return best;
    }

    const OutlineViews& views_;
    const std::vector<NamedTurn>& turns_;
    Box hull_, mesh_;
};

bool may_be_cut_out(const OutlineOverlap& overlap) {
    return overlap.iou >= min_overlap_of_cut_out && overlap.masks_covered >= min_masks_covered;
}

/// True if the best placement is worth reporting.
bool is_told_by(const OutlineViews& views, const FrameFit& fit) {
    if (fit.best.overlap < fit.overlap + plainly_better) return false;
    return fit.best.overlap >= min_overlap || may_be_cut_out(views.compare(fit.best));
}

[[noreturn]] void refuse_frame(const FrameFit& fit, const std::string& file,
                               const std::string& problem) {
    if (!fit.best_fits) {
        throw InputError(
            file, problem,
            "no axis rotation, unit or position fits; give the mesh in the coordinates of the "
            "photographs (see world_from_dataset in docs/reconstruct.md)");
    }
    const bool is_turn = fit.best.scale == 1 && fit.best.move == Vec3(0.0f);
    throw InputError(file, problem,
                     fmt::format("{}, they overlap by {:.0f} %; {} or use --place-mesh",
                                 fit.best.words, 100 * fit.best.overlap,
                                 is_turn ? "rotate the mesh" : "place the mesh like this"));
}

std::string overlap_words(const FrameFit& fit) {
    return fmt::format("the mesh's outlines overlap the masks by {:.0f} %", 100 * fit.overlap);
}

}  // namespace

FrameFit fit_frame(const TriangleMesh& mesh, const Dataset& dataset) {
    const at::NoGradGuard no_gradient;
    const OutlineViews views(mesh, some_views(dataset.train, frame_views), compared_side);
    const OutlineOverlap now = views.compare({}, true);
    FrameFit fit;
    fit.overlap = now.iou;
    fit.agreement = now.agreement;
    fit.masks_covered = now.masks_covered;
    fit.may_be_cut_out = may_be_cut_out(now);
    fit.best.overlap = now.iou;
    fit.fits = now.iou >= min_overlap || now.agreement >= min_agreement;
    if (fit.fits) return fit;
    const std::vector<NamedTurn> turns = turns_to_try(dataset.world_from_dataset);
    for (const NamedTurn& turn : turns) {
        Placement placement{turn.matrix, 1, Vec3(0.0f), "", 0};
        placement.overlap = views.compare(placement).iou;
        if (placement.overlap <= fit.best.overlap + overlap_noise) continue;
        placement.words = "rotated by " + turn.words;
        fit.best = placement;
    }
    fit.best_fits = is_told_by(views, fit);
    if (fit.best_fits) return fit;
    const std::optional<Box> hull = hull_box(dataset);
    if (!hull) return fit;
    const PlacementSearch search(views, turns, *hull);
    const auto take = [&](const Placement& placement, double gain) {
        if (placement.overlap <= fit.best.overlap + gain) return;
        fit.best = placement;
        fit.best_fits = is_told_by(views, fit);
    };
    const Placement unit = search.unit();
    if (unit.overlap >= overlap_of_unit) {
        take(unit, plainly_better);
        if (fit.best_fits) return fit;
    }
    // A mesh that covers all of the masks may be right, so it is not moved elsewhere.
    if (fit.may_be_cut_out) return fit;
    take(search.scale(), plainly_better);
    if (fit.best.overlap > well_placed) return fit;
    take(search.place(), fit.best_fits ? worth_a_move : plainly_better);
    return fit;
}

std::string check_mesh_frame(const TriangleMesh& mesh, const Dataset& dataset,
                             const std::string& file) {
    const FrameFit fit = fit_frame(mesh, dataset);
    if (fit.fits) return {};
    const std::string problem = overlap_words(fit);
    if (fit.best_fits || !fit.may_be_cut_out) refuse_frame(fit, file, problem);
    return file + ": " + problem + ": it is larger than the object in the masks";
}

Placement place_mesh(const TriangleMesh& mesh, const Dataset& dataset, const std::string& file) {
    const FrameFit fit = fit_frame(mesh, dataset);
    if (fit.fits || (!fit.best_fits && fit.may_be_cut_out)) {
        Placement as_it_is;
        as_it_is.overlap = fit.overlap;
        return as_it_is;
    }
    if (!fit.best_fits) refuse_frame(fit, file, overlap_words(fit));
    Placement placement = fit.best;
    const auto units = scales_near(placement.scale);
    const bool is_unit =
        placement.scale == 1 || (!units.empty() && units.front().factor == placement.scale);
    // An exact placement is not refined.
    if (is_unit && placement.move == Vec3(0.0f)) return placement;
    const at::NoGradGuard no_gradient;
    const OutlineViews views(mesh, some_views(dataset.train, refining_views), refining_side);
    const Box box{views.mesh_bounds()[0], views.mesh_bounds()[1]};
    placement.overlap = views.compare(placement).iou;
    improve_placement(views, box.middle(), placement.scale * box.longest(), 0.02f, 0.001f, true,
                      1.0, placement);
    return placement;
}

}  // namespace item3d
