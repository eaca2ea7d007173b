// The fit of the neural texture to the model's own materials, from which an edit starts.
#pragma once

#include "item3d/field/neural_texture.h"
#include "item3d/field/surface_points.h"
#include "item3d/render/textured_materials.h"

namespace item3d {

struct FitOptions {
    int steps = 200;            ///< number, after up to 40 steps with a constant hash table
    std::int64_t batch = 4096;  ///< surface points in a step
    double table_learning_rate = 0.03;
    double network_learning_rate = 0.01;
    std::uint64_t seed = 0;
    bool show_progress = true;
};

struct FitResult {
    double seconds = 0.0;
    double base_color_psnr = 0.0;  ///< dB, sRGB-encoded base colour, at new surface points
    double orm_psnr = 0.0;         ///< dB, occlusion, roughness and metallic
};

/// Returns options of a field for the edited surface: its bounds, and a finest resolution and table
/// size for `texture_size` texels along an edge of the atlas.
NeuralTextureOptions suggest_field_options(const Geometry& geometry, const FieldSpace& space,
                                           int texture_size = 1024, std::uint64_t seed = 0);

/// Regresses the field to the materials at random surface points by squared error, with
/// sRGB-encoded base colour. Deterministic in options.seed. Throws Interrupted after Ctrl-C.
FitResult fit_to_materials(NeuralTexture& field, const Geometry& geometry, const FieldSpace& space,
                           const TexturedMaterials& materials, const FitOptions& options = {});

/// Shifts an output, before its activation, so that its mean over the edited surface becomes
/// `mean`. Differences between values at the end of the range are invisible, but would become
/// blotches after the shift; they are scaled down.
void shift_mean(NeuralTexture& field, const Geometry& geometry, const FieldSpace& space,
                OrmChannel channel, float mean);

}  // namespace item3d
