// Everything that an edit changes, which is what a checkpoint holds.
#pragma once

#include "item3d/baselines/view_painter.h"
#include "item3d/field/adam.h"
#include "item3d/field/neural_texture.h"
#include "item3d/guidance/guidance.h"
#include "item3d/lighting/optimized/light_model.h"
#include "item3d/networks/vision_language/captioner.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// A line of the record of how an edit went, for the report, edit.json and the checkpoint.
struct AdjustmentRecord {
    std::int64_t iteration = 0;         ///< steps done by then
    std::vector<std::string> captions;  ///< of the views; none where nobody was asked
    std::optional<TextDirection> text;  ///< of methods with a source: after this adjustment
    std::optional<double> direction;    ///< mean of direction_length since the line before
    std::optional<double> source_loss;  ///< the same of the source's denoising loss
    at::Tensor picture;                 ///< [P, P, 3] uint8 sRGB; not in the JSON
};

/// "iteration", and of the rest what is there: "captions", "angle", "length", "direction",
/// "source_loss".
void to_json(nlohmann::json& json, const AdjustmentRecord& record);
void from_json(const nlohmann::json& json, AdjustmentRecord& record);

/// Direction adjustment so far; what it did to the source is in the guidance's own state.
struct AdjustmentState {
    std::vector<AdjustmentRecord> records;
    std::vector<Caption> captions_before;  ///< of the unedited model, one for each view
    std::string failure;                   ///< why the captioner is not asked any more
};

/// The detail stage so far.
struct DetailState {
    NeuralTexture before{nullptr};    ///< the field at its beginning; empty: not begun
    Adam optimizer;                   ///< of "table" and "network"
    std::vector<at::Tensor> targets;  ///< [1, 3, R, R] sRGB, one for each view so far

    bool has_begun() const { return !before.is_empty(); }
    /// At the field as it is. The stage itself sets the learning rates.
    void begin(const NeuralTexture& field);
};

struct EditState {
    NeuralTexture fitted{nullptr};  ///< the field as fitted to the input, for the bake's residual
    NeuralTexture field{nullptr};
    Adam optimizer;                      ///< of "table" and "network" of the field, and "light"
    std::unique_ptr<LightModel> light;   ///< null where the light is not optimised
    EnvironmentLight first_light;        ///< what `light` began as
    std::unique_ptr<Guidance> guidance;  ///< null with a painter
    std::unique_ptr<PaintingScene> painting;  ///< of a method that paints views; else null
    std::unique_ptr<ViewPainter> painter;     ///< null with it; then there is no field
    /// Diffusion models that the edit asks, and rows of their U-Nets that runs before this one
    /// asked.
    std::vector<std::shared_ptr<const DiffusionModel>> networks;
    std::int64_t earlier_unet_rows = 0;
    std::int64_t unet_rows_elsewhere = 0;  ///< of this run's other processes
    std::int64_t own_unet_rows() const;    ///< of this process
    /// Of all runs and processes of the edit together.
    std::int64_t unet_rows() const;
    DetailState detail;
    AdjustmentState adjustment;
    std::string prior_weights;  ///< hash_of_weights() of what guides it
    std::string begun;          ///< when the edit began: utc_date()
    /// Iterations done, views of the detail stage included; iterations that a settled edit was
    /// spared count as done.
    std::int64_t iteration = 0;
    std::vector<float> direction_length;  ///< a curve of the report, one value an iteration
    std::vector<float> source_loss;       ///< another
};

}  // namespace item3d
