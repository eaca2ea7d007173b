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

/// Weights of the losses beside the image loss.
struct RegularizerWeights {
    double mask = 1.0;          ///< coverage
    double smoothness = 0.005;  ///< small variation of base colour, roughness and metallic
    double whiteness = 0.003;   ///< little colour in the light
    LightScaleWeights light_scale;
    double decision = 0.01;      ///< metallic of 0 or 1, after decision_begin
    double dark_metal = 0.03;    ///< bright metals, after decision_begin
    double rough_metal = 0.1;    ///< metals that are not rough, after decision_begin
    double crumpling = 0.05;     ///< joint motion of vertices
    double flat_normals = 0.01;  ///< flat normal map
};

struct RefineOptions {
    int iterations = 1000;
    int light_every = 2;  ///< number of iterations per prefiltered light
    /// Fraction of the iterations in which the whole view has one material, so that the light
    /// explains shading first.
    double light_alone = 0.15;
    /// Fraction of the iterations after which metallic is pushed to 0 or 1. Earlier, undecided
    /// values would fall to the wrong side.
    double decision_begin = 0.6;
    bool normal_map = true;
    /// Traces self-shadowing and interreflection: of uniform light at first, then of the light
    /// found so far. Otherwise shadows and glow end up in the base colour.
    bool shadows = true;
    int traces = 8;                      ///< total number
    std::int64_t shadow_points = 32768;  ///< OcclusionOptions::max_points
    double field_learning_rate = 0.01;
    double light_learning_rate = 0.05;
    double light_scale_learning_rate = 0.02;
    double vertex_learning_rate = 0.02;  ///< in mean edges
    RegularizerWeights weights;
    std::uint64_t seed = 0;
};

/// Stage with one view per step in shuffled order, and Adam with rates that decay to a tenth.
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
    /// Inputs of the traced shadows: a resumed run traces them again.
    struct Traced {
        at::Tensor offsets;   ///< offsets of the mesh; undefined: it is fixed
        at::Tensor radiance;  ///< [H, 2H, 3]; undefined: uniform light
        at::Tensor indirect;  ///< IndirectLight::stored(); undefined: none
    };
    void trace();
    RenderedView render(const TargetView& view, ViewRenderOptions how);
    at::Tensor regularization(const RenderedView& rendered, const at::Tensor& mask);

    MovableMesh& mesh_;
    std::vector<TargetView> views_;
    RefineOptions options_;
    std::map<std::string, double> rates_;  ///< by group of the optimiser
    float pixel_;                          ///< world units
    float farthest_;                       ///< maximum distance of smoothness, world units
    ViewOrder order_;
    Traced traced_;
    std::optional<Occlusion> occlusion_;
    std::optional<IndirectLight> indirect_;
};

}  // namespace item3d
