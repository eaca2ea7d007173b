// Materials, light, and where asked vertices, of a mesh of fixed connections.
#pragma once

#include "item3d/field/neural_texture.h"
#include "item3d/reconstruct/surface/movable_mesh.h"
#include "item3d/reconstruct/surface/trainable_light.h"
#include "item3d/reconstruct/surface/view_render.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Weights of what is asked besides that renders look like the photographs.
struct RegularizerWeights {
    double mask = 1.0;           ///< coverage
    double smoothness = 0.05;    ///< base colour, roughness and metallic vary little
    double whiteness = 0.003;    ///< the light has little colour
    double brightness = 0.5;     ///< white is like paper
    double crumpling = 0.05;     ///< vertices move together
    double flat_normals = 0.01;  ///< the normal map is flat
};

struct RefineOptions {
    int iterations = 1000;
    int light_every = 2;  ///< iterations for which a prefiltered light is used
    /// Part of the iterations in which the whole view has one material, so that shading is first
    /// explained by the light.
    double light_alone = 0.15;
    bool normal_map = true;
    /// Light that the object itself keeps away is traced: from everywhere at first, then of the
    /// light that was found so far, three times. Otherwise shadows end up in the base colour.
    bool shadows = true;
    double field_learning_rate = 0.01;
    double light_learning_rate = 0.05;
    double vertex_learning_rate = 0.02;  ///< in mean edges
    RegularizerWeights weights;
    std::uint64_t seed = 0;
};

struct Appearance {
    NeuralTexture field = nullptr;
    TrainableLight light;
};

struct RefineCurves {
    std::vector<double> picture, mask;
};

/// Ranges of the materials that are looked for.
MaterialRanges reconstruction_ranges();

/// A field around `bounds` whose finest cells are about the size of a pixel of the photographs.
Appearance make_appearance(std::array<Vec3, 2> bounds, const std::vector<TargetView>& views,
                           std::uint64_t seed);

/// Optimises the appearance and the mesh's offsets, one view an iteration in shuffled order, Adam
/// with rates that fall to a tenth. Throws Interrupted.
RefineCurves refine(Appearance& appearance, MovableMesh& mesh, const Model& model,
                    const std::vector<TargetView>& views, const RefineOptions& options);

}  // namespace item3d
