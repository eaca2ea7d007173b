// Makes the neural texture look like the model's own materials, so that an edit starts there.
#pragma once

#include "item3d/field/neural_texture.h"
#include "item3d/field/surface_points.h"
#include "item3d/render/textured_materials.h"

namespace item3d {

struct FitOptions {
    int steps = 200;            ///< after up to 40 in which the table stays as it is
    std::int64_t batch = 4096;  ///< surface points a step
    double table_learning_rate = 0.03;
    double network_learning_rate = 0.01;
    std::uint64_t seed = 0;
    bool show_progress = true;
};

struct FitResult {
    double seconds = 0.0;
    double base_color_psnr = 0.0;  ///< dB, sRGB-encoded base colour, at fresh surface points
    double orm_psnr = 0.0;         ///< dB, occlusion, roughness and metallic
};

/// A field for the edited surface: bounds around it, and a finest lattice and table that suit
/// `texture_size` texels along an edge of the atlas.
NeuralTextureOptions suggest_field_options(const Geometry& geometry, const FieldSpace& space,
                                           int texture_size = 1024, std::uint64_t seed = 0);

/// Regresses the field to the materials at random surface points: squared error, of the base colour
/// sRGB-encoded. Deterministic in options.seed. Throws Interrupted after Ctrl-C.
FitResult fit_to_materials(NeuralTexture& field, const Geometry& geometry, const FieldSpace& space,
                           const TexturedMaterials& materials, const FitOptions& options = {});

/// Moves an output so that its mean over the edited surface becomes `mean`, by a constant before
/// its range is applied. Where values lie at the range's end, differences that cannot be seen there
/// would come out as blotches: they are scaled down.
void shift_mean(NeuralTexture& field, const Geometry& geometry, const FieldSpace& space,
                OrmChannel channel, float mean);

}  // namespace item3d
