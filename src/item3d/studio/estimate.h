// Estimates of an edit's time and memory before it starts.
#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <vector>

namespace item3d {

/// Cost of an edit, from its edit.json.
struct EditCost {
    double iterations = 0;  ///< number of iterations done
    double pixels = 0;      ///< pixels per iteration: batch times resolution squared
    double optimize = 0;    ///< seconds of the iterations
    double detail = 0;      ///< seconds of the detail stage; 0 without this stage
    double before = 0;      ///< seconds until the first iteration
    double after = 0;       ///< seconds of textures and images
    double memory = 0;      ///< peak memory in bytes
};

/// Expected seconds of an edit's parts.
struct EditPlanSeconds {
    double before = 0, optimize = 0, detail = 0, after = 0;

    double total() const { return before + optimize + detail + after; }
};

/// Returns the cost in a summary. Returns nullopt if the summary lacks values, or if the run was
/// resumed from a checkpoint, because its time is then incomplete.
std::optional<EditCost> edit_cost(const nlohmann::json& summary);

/// Estimates the seconds of an edit. The edit takes less if it converges early. request: request as
/// the page sends it. defaults: the prior's settings. former: costs of edits on this machine. The
/// medians of these costs are used, and the time of an iteration is scaled by its number of pixels.
/// If `former` is empty, the cost of the demo edit on two cores is scaled to `threads`.
EditPlanSeconds expected_seconds(const nlohmann::json& request, const nlohmann::json& defaults,
                                 const std::vector<EditCost>& former, int threads);

/// Returns the estimate as JSON: "seconds", "memory_bytes", "iterations", "detail" and "basis"
/// ("edits on this machine", or "the demo edit elsewhere").
nlohmann::json estimate_edit(const nlohmann::json& request, const nlohmann::json& defaults,
                             const std::vector<EditCost>& former, int threads);

}  // namespace item3d
