#include "item3d/reconstruct/shape/align_poses.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/reconstruct/shape/find_shape.h"
#include "item3d/reconstruct/shape/visual_hull.h"
#include "item3d/render/antialias.h"
#include "item3d/report/display_image.h"

#include <algorithm>

namespace item3d {

namespace {

constexpr double small = 0.04;  ///< disagreement of outlines below which poses are kept, in pixels
constexpr int rounds = 4, passes = 12;
constexpr int passes_of_tests = 24;
constexpr double faster = 4;  ///< quotient of the learning rate and that of the shape stage
constexpr int cells = 64;
constexpr int image_side = 128;
/// Fraction of the views that may exclude a point although it is inside.
constexpr double ignored_share = 0.08;

std::vector<Photograph> smaller(std::vector<Photograph> views) {
    for (Photograph& view : views)
        view.image = thumbnail(view.image, image_side);
    return views;
}

/// Returns the hull that all but a few outlines allow.
TriangleMesh robust_hull(const Dataset& dataset, const std::vector<Photograph>& views,
                         const std::string& subject) {
    const auto ignored =
        static_cast<std::size_t>(ignored_share * static_cast<double>(views.size()) + 0.5);
    const VisualHull hull(views);
    const auto bounds = hull.bounds(dataset.centre, dataset.radius, subject, ignored);
    const Lattice lattice = make_lattice(bounds, cells);
    ShapeField field(lattice, "tetrahedra",
                     hull.distance(lattice.vertices(), ignored) / lattice.cell);
    return field.mesh();
}

at::Tensor outline_loss(const Geometry& geometry, const RigidMotion& motion,
                        const TargetView& view) {
    const Geometry seen = motion.moved(geometry);
    const Raster raster = rasterize(seen, {view.camera}, view.width(), view.height());
    const at::Tensor inside = (raster.triangle >= 0).to(at::kFloat).unsqueeze(3);
    return mask_loss(antialias(inside.expand({-1, -1, -1, 4}).contiguous(), raster, seen),
                     view.image);
}

/// Alignment of one mesh's outlines with the masks.
class OutlineFit {
  public:
    OutlineFit(const TriangleMesh& mesh, const std::vector<Photograph>& views,
               const Dataset& dataset, ViewCorrections& corrections)
        : geometry_(untextured_geometry(mesh.positions, mesh.triangles)),
          targets_(make_targets(views, {dataset.centre - Vec3(dataset.radius),
                                        dataset.centre + Vec3(dataset.radius)})),
          corrections_(corrections) {
        corrections.add_groups(adam_);
    }

    /// Performs a step for every view.
    void pass(double rate) {
        if (interrupted()) throw Interrupted("nothing was saved yet");
        corrections_.set_rates(adam_, faster * rate);
        for (std::size_t i = 0; i < targets_.size(); ++i) {
            (outline_loss(geometry_, corrections_.motion(i), targets_[i]) +
             corrections_.motion_loss(i))
                .backward();
            adam_.step();
            adam_.zero_grad();
        }
    }

  private:
    Geometry geometry_;
    std::vector<TargetView> targets_;
    ViewCorrections& corrections_;
    Adam adam_;
};

}  // namespace

std::vector<Photograph> aligned_to_mesh(const TriangleMesh& mesh, const Dataset& dataset,
                                        const std::vector<Photograph>& views) {
    ViewCorrections corrections(views, dataset.centre, dataset.radius,
                                {PoseRefinement::refine, false});
    OutlineFit fit(mesh, views, dataset, corrections);
    for (int pass = 0; pass < passes_of_tests; ++pass)
        fit.pass(1.0 - 0.95 * pass / passes_of_tests);
    return corrections.corrected(views);
}

double align_to_hull(const Dataset& dataset, const std::string& subject,
                     ViewCorrections& corrections) {
    const auto disagreement = [&] {
        const auto views = corrections.corrected(dataset.train);
        return VisualHull(views).disagreement(views, dataset.centre, dataset.radius);
    };
    const PoseRefinement wanted = corrections.options().poses;
    const double before = disagreement();
    if (wanted == PoseRefinement::keep || (wanted == PoseRefinement::automatic && before < small))
        return before;
    corrections.decide(true);
    const std::vector<Photograph> views = smaller(dataset.train);

    Progress progress("poses", rounds * passes);
    for (int round = 0; round < rounds; ++round) {
        const TriangleMesh mesh = robust_hull(dataset, corrections.corrected(views), subject);
        OutlineFit fit(mesh, views, dataset, corrections);
        for (int pass = 0; pass < passes; ++pass) {
            const int done = round * passes + pass;
            fit.pass(1.0 - 0.9 * done / (rounds * passes));
            progress.update(done + 1, "");
        }
    }
    progress.finish();
    const double after = disagreement();
    note(fmt::format("poses: the outlines disagreed by {:.2f} pixels, now by {:.2f}", before,
                     after));
    return after;
}

}  // namespace item3d
