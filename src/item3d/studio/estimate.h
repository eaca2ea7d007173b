// How long an edit will take and how much memory, before it starts.
#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <vector>

namespace item3d {

/// What an edit took, of its edit.json.
struct EditCost {
    double iterations = 0;  ///< that it did
    double pixels = 0;      ///< of each iteration: batch times resolution squared
    double optimize = 0;    ///< seconds
    double detail = 0;      ///< seconds of the detail stage; 0: none
    double rest = 0;        ///< seconds of all else
    double memory = 0;      ///< bytes
};

/// Nothing where the summary lacks values, or is of a run that went on from a checkpoint and so
/// does not have all of the time.
std::optional<EditCost> edit_cost(const nlohmann::json& summary);

/// "seconds", "memory_bytes" and "basis" ("edits on this machine", or "the demo edit elsewhere").
///
/// request: as the page sends it; defaults: the prior's settings. former: costs of edits on this
/// machine, of which medians are taken; the seconds of an iteration follow its pixels. Without any,
/// those of the demo edit on two cores, divided by threads. An edit that settles takes less.
nlohmann::json estimate_edit(const nlohmann::json& request, const nlohmann::json& defaults,
                             const std::vector<EditCost>& former, int threads);

}  // namespace item3d
