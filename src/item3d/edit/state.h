// The mutable state of an edit, which a checkpoint stores.
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

/// An entry in the record of an edit's course. The record is in the report, edit.json and the
/// checkpoint.
struct AdjustmentRecord {
    std::int64_t iteration = 0;         ///< number of iterations done at this time
    std::vector<std::string> captions;  ///< one for each view; empty without a captioner
    std::optional<TextDirection> text;  ///< direction after this adjustment; none without a source
    std::optional<double> direction;    ///< mean of direction_length since the previous entry
    std::optional<double> source_loss;  ///< mean of the source's denoising loss since then
    at::Tensor image;                   ///< [P, P, 3] uint8 sRGB; not in the JSON
};

/// Writes "iteration", and each of "captions", "angle", "length", "direction" and "source_loss"
/// that has a value.
void to_json(nlohmann::json& json, const AdjustmentRecord& record);
void from_json(const nlohmann::json& json, AdjustmentRecord& record);

/// Record of direction adjustment. The adjusted source embedding is stored in the guidance's state.
struct AdjustmentState {
    std::vector<AdjustmentRecord> records;
    std::vector<Caption> captions_before;  ///< captions of the unedited model, one for each view
    std::string failure;  ///< error that disabled the captioner; empty if there was none
};

/// State of the detail stage.
struct DetailState {
    NeuralTexture before{nullptr};    ///< field when the stage began; empty before that
    Adam optimizer;                   ///< for "table" and "network"
    std::vector<at::Tensor> targets;  ///< [1, 3, R, R] sRGB, one for each finished view

    bool has_begun() const { return !before.is_empty(); }
    /// Begins the stage with this field. Learning rates are set later, by the stage.
    void begin(const NeuralTexture& field);
};

struct EditState {
    /// Field fitted to the unedited materials, for the bake's residual.
    NeuralTexture fitted{nullptr};
    NeuralTexture field{nullptr};
    Adam optimizer;                      ///< for the field's "table" and "network", and for "light"
    std::unique_ptr<LightModel> light;   ///< null if the light is not optimised
    EnvironmentLight first_light;        ///< initial value of `light`
    std::unique_ptr<Guidance> guidance;  ///< null if there is a painter
    std::unique_ptr<PaintingScene> painting;  ///< null unless the method paints views
    std::unique_ptr<ViewPainter> painter;     ///< null without `painting`; used in place of `field`
    /// Diffusion models that the edit runs, and the number of rows (batch entries) that their
    /// U-Nets evaluated in earlier runs.
    std::vector<std::shared_ptr<const DiffusionModel>> networks;
    std::int64_t earlier_unet_rows = 0;
    std::int64_t unet_rows_elsewhere = 0;  ///< rows that other processes evaluated in this run
    std::int64_t own_unet_rows() const;    ///< rows that this process evaluated
    /// Returns the number of rows over all runs and processes of the edit.
    std::int64_t unet_rows() const;
    DetailState detail;
    AdjustmentState adjustment;
    std::string prior_weights;  ///< hash_of_weights() of the guiding prior
    std::string begun;          ///< utc_date() at the start of the edit
    /// Number of finished iterations, including views of the detail stage and iterations skipped by
    /// convergence.
    std::int64_t iteration = 0;
    std::vector<float> direction_length;  ///< one value for each iteration; a curve of the report
    std::vector<float> source_loss;       ///< one value for each iteration; a curve of the report
};

}  // namespace item3d
