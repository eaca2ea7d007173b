// Shape from photographs: a signed field on a lattice, optimised together with first materials and
// light (Munkberg et al. 2022, "Extracting Triangular 3D Models, Materials, and Lighting From
// Images").
#pragma once

#include "item3d/reconstruct/shape/clean_mesh.h"
#include "item3d/reconstruct/shape/visual_hull.h"
#include "item3d/reconstruct/surface/refine.h"

#include <cstdint>
#include <vector>

namespace item3d {

struct ShapeOptions {
    std::vector<int> cells{48, 96};     ///< along the box's longest edge, each twice the one before
    int iterations = 1000;              ///< in all; half as many on every lattice but the last
    double value_learning_rate = 0.02;  ///< in cells
    double offset_learning_rate = 0.01;  ///< in cells
    double mask_weight = 2.0;
    double sign_change_weight_first = 0.05, sign_change_weight_last = 0.005;
    double smoothness_weight = 0.03;
    double whiteness_weight = 0.003;
    double brightness_weight = 0.5;
    double light_alone = 0.15;  ///< part of the iterations, see RefineOptions
    int light_every = 2;
    int triangles = 20000;  ///< of the mesh that comes back, at most about
    std::uint64_t seed = 0;
};

struct Shape {
    TriangleMesh mesh;
    RefineCurves curves;
    std::vector<std::int64_t> triangles;  ///< of the marched surface, by iteration
    double hull_overlap = 0;  ///< of the hull's outlines with the masks: intersection over union
};

/// appearance: learns with the shape, so that shading tells of hollows that no outline shows.
Shape find_shape(const Dataset& dataset, const VisualHull& hull, std::array<Vec3, 2> bounds,
                 Appearance& appearance, const ShapeOptions& options);

/// Sum over views of the pixels that both outlines cover, over those that either does.
double mask_overlap(const TriangleMesh& mesh, const std::vector<TargetView>& views);

/// A mesh as the renderer takes it, with smooth normals that carry gradients to the positions.
Geometry untextured_geometry(const torch::Tensor& positions, const torch::Tensor& triangles);

}  // namespace item3d
