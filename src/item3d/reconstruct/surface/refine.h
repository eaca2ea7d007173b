// Refinement of materials, light and optionally vertices on a mesh of fixed topology.
#pragma once

#include "item3d/reconstruct/stage.h"
#include "item3d/reconstruct/surface/light_scale.h"
#include "item3d/reconstruct/surface/movable_mesh.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Weights of the losses other than the image loss. The comments name what each loss favours.
struct RegularizerWeights {
    double mask = 1.0;          ///< coverage
    double smoothness = 0.005;  ///< small variation of base colour, roughness and metallic
    double whiteness = 0.003;   ///< little colour in the light
    LightScaleWeights light_scale;
    double decision = 0.01;      ///< metallic values of 0 or 1, after decision_begin
    double dark_metal = 0.03;    ///< bright metals, after decision_begin
    double rough_metal = 0.1;    ///< metals that are not rough, after decision_begin
    double crumpling = 0.05;     ///< similar motion of neighbouring vertices
    double flat_normals = 0.01;  ///< flat normal map
};

struct RefineOptions {
    int iterations = 1000;
    int light_every = 2;  ///< the light is optimised in every n-th iteration
    /// Fraction of the iterations, at the start, in which the whole view has one material. During
    /// these iterations the light alone explains the shading.
    double light_alone = 0.15;
    /// Fraction of the iterations after which metallic is pushed to 0 or 1. If this began earlier,
    /// values that are still undecided would be pushed to the wrong one of these two values.
    double decision_begin = 0.6;
    bool normal_map = true;
    /// True if self-shadowing and interreflection are traced. Without them, shadows and reflected
    /// light end up in the base colour. The first tracing assumes uniform light and no
    /// interreflection; later ones use the light found so far.
    bool shadows = true;
    int traces = 8;                      ///< total number of tracings
    std::int64_t shadow_points = 32768;  ///< OcclusionOptions::max_points
    double field_learning_rate = 0.01;
    double light_learning_rate = 0.05;
    double light_scale_learning_rate = 0.02;
    double vertex_learning_rate = 0.02;  ///< rate in units of the mean edge length
    RegularizerWeights weights;
    std::uint64_t seed = 0;
};

/// Stage of refinement. It uses one view per step, in shuffled order, and Adam with learning rates
/// that decay to a tenth.
class Refinement : public Stage {
  public:
    /// Optimises the appearance, the corrections of `views` and the mesh's offsets; all of these
    /// must outlive this object.
    Refinement(Appearance& appearance, ViewCorrections& corrections, MovableMesh& mesh,
               const Model& model, std::vector<TargetView> views, const RefineOptions& options);

    std::string name() const override { return "materials and light"; }
    int iterations() const override { return options_.iterations; }
    void step() override;
    std::string detail() const override;
    RenderedView draw(const TargetView& view) override;
    NamedTensors state() const override;
    void load_state(const CheckpointReader& reader) override;
    const RefineCurves& curves() const { return learning_.curves; }

  private:
    /// Inputs of the last tracing of shadows. A resumed run traces the shadows again from these
    /// inputs.
    struct Traced {
        at::Tensor offsets;   ///< offsets of the mesh; undefined if the mesh does not move
        at::Tensor radiance;  ///< [H, 2H, 3]; undefined for uniform light
        at::Tensor indirect;  ///< IndirectLight::stored(); undefined if there is none
    };
    void trace();
    RenderedView render(const TargetView& view, ViewRenderOptions how);
    at::Tensor regularization(const RenderedView& rendered, const at::Tensor& mask);

    MovableMesh& mesh_;
    std::vector<TargetView> views_;
    RefineOptions options_;
    std::map<std::string, double> rates_;  ///< learning rate of each group of the optimiser
    float pixel_;                          ///< size of a pixel in world units
    /// Maximum distance in smoothness_loss(), in world units.
    float farthest_;
    ViewOrder order_;
    Traced traced_;
    std::optional<Occlusion> occlusion_;
    std::optional<IndirectLight> indirect_;
};

}  // namespace item3d
