// The fit of the neural texture to the model's own materials, from which an edit starts.
#pragma once

#include "item3d/field/neural_texture.h"
#include "item3d/field/surface_points.h"
#include "item3d/render/textured_materials.h"

namespace item3d {

struct FitOptions {
    int steps = 200;            ///< steps that follow up to 40 with a constant hash table
    std::int64_t batch = 4096;  ///< surface points in a step
    double table_learning_rate = 0.03;
    double network_learning_rate = 0.01;
    std::uint64_t seed = 0;
    bool show_progress = true;
};

struct FitResult {
    double seconds = 0.0;
    double base_color_psnr = 0.0;  ///< dB; of sRGB-encoded base colour at new surface points
    double orm_psnr = 0.0;         ///< dB; of occlusion, roughness and metallic there
};

/// Returns the options of a field for the edited surface. They have the surface's bounds, and a
/// finest resolution for `texture_size` texels along an edge of the atlas.
NeuralTextureOptions suggest_field_options(const Geometry& geometry, const FieldSpace& space,
                                           int texture_size = 1024, std::uint64_t seed = 0);

/// Fits the field to the materials at random surface points by least squares, with sRGB-encoded
/// base colour. Deterministic in options.seed. Throws Interrupted after Ctrl-C.
FitResult fit_to_materials(NeuralTexture& field, const Geometry& geometry, const FieldSpace& space,
                           const TexturedMaterials& materials, const FitOptions& options = {});

/// Shifts an output, before its activation, so that its mean over the edited surface becomes
/// `mean`. Differences between values at the end of the range are invisible before the shift, but
/// would become blotches after it, so they are scaled down.
void shift_mean(NeuralTexture& field, const Geometry& geometry, const FieldSpace& space,
                OrmChannel channel, float mean);

}  // namespace item3d
