// Shape from photographs: a signed field on a lattice, optimised jointly with initial materials and
// light (Munkberg et al. 2022, "Extracting Triangular 3D Models, Materials, and Lighting From
// Images").
#pragma once

#include "item3d/reconstruct/shape/surface_extraction.h"
#include "item3d/reconstruct/shape/visual_hull.h"
#include "item3d/reconstruct/stage.h"
#include "item3d/reconstruct/surface/light_scale.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct ShapeOptions {
    std::string extraction = "flexicubes";  ///< see extraction_names()
    /// Number of cells along the box's longest edge, for each lattice. Each number is twice the one
    /// before.
    std::vector<int> cells{48, 96};
    /// Total number; every lattice but the last gets half as many as the last.
    int iterations = 1000;
    double value_learning_rate = 0.05;   ///< rate in cells
    double offset_learning_rate = 0.01;  ///< rate in cells
    double weight_learning_rate = 0.02;  ///< rate of the extraction's own parameters
    double mask_weight = 2.0;
    double regularizer_weight = 0.1;  ///< weight of the extraction's regulariser
    double sign_change_weight_first = 0.05, sign_change_weight_last = 0.005;
    double smoothness_weight = 0.03;
    double whiteness_weight = 0.003;
    LightScaleWeights light_scale;
    double light_alone = 0.15;  ///< fraction of the iterations, see RefineOptions
    int light_every = 2;
    int triangles = 20000;  ///< approximate maximum for the resulting mesh
    std::uint64_t seed = 0;
};

struct FoundShape {
    TriangleMesh mesh;
    RefineCurves curves;
    std::vector<double> triangles;  ///< number of triangles in the extracted surface, by iteration
    double outline_disagreement = 0;  ///< pixels, see VisualHull::disagreement()
};

/// Optimised signed field on one lattice.
struct ShapeField {
    /// start: initial values [V], in cells.
    ShapeField(const Lattice& lattice, const std::string& extraction, const at::Tensor& start);
    /// Returns the lattice vertices [V, 3] with their offsets.
    at::Tensor vertices() const;
    /// Returns the current surface, without gradients; may be empty.
    TriangleMesh mesh();

    float cell;
    std::unique_ptr<SurfaceExtraction> extraction;
    at::Tensor places;   ///< [V, 3]
    at::Tensor values;   ///< [V] in cells
    at::Tensor offsets;  ///< [V, 3], before tanh
};

class ShapeSearch : public Stage {
  public:
    /// `appearance` is optimised together with the shape, because shading reveals concavities that
    /// no outline shows. `corrections` are optimised too. Both arguments must outlive this object.
    ShapeSearch(const Dataset& dataset, const VisualHull& hull, std::array<Vec3, 2> bounds,
                Appearance& appearance, ViewCorrections& corrections, const ShapeOptions& options);

    std::string name() const override { return "shape"; }
    int iterations() const override { return options_.iterations; }
    void step() override;
    std::string detail() const override;
    RenderedView draw(const TargetView& view) override;
    NamedTensors state() const override;
    void load_state(const CheckpointReader& reader) override;

    /// Returns the cleaned and simplified mesh, after the last iteration.
    FoundShape shape();

  private:
    int end_of_level(int level) const;
    void begin_level(int level, const at::Tensor& start);
    void start_next_level();
    at::Tensor loss_besides_image(const RenderedView& rendered, const ExtractedSurface& surface,
                                  bool light_alone);

    ShapeOptions options_;
    Lattice lattice_;
    std::vector<TargetView> views_;
    ViewOrder order_;
    std::unique_ptr<ShapeField> field_;
    int level_ = 0;  ///< index into the options' cells
    std::vector<double> triangles_;
};

/// Returns the intersection over union of the pixels that the mesh and the masks cover.
/// Intersection and union are summed over the views.
double mask_overlap(const TriangleMesh& mesh, const std::vector<TargetView>& views);

/// Returns a mesh as renderer geometry, with smooth normals that carry gradients to the positions.
Geometry untextured_geometry(const at::Tensor& positions, const at::Tensor& triangles);

}  // namespace item3d
