// How an edit went: lines of a record, for the report, edit.json and the checkpoint.
#pragma once

#include "item3d/guidance/text_direction.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

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

}  // namespace item3d
