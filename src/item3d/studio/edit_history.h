// Costs of earlier edits on this machine, for estimates.
#pragma once

#include "item3d/studio/estimate.h"
#include "item3d/studio/folders.h"
#include "item3d/studio/store.h"

#include <nlohmann/json.hpp>

#include <vector>

namespace item3d {

struct EditHistory {
    nlohmann::json defaults;      ///< settings of the shipped prior
    std::vector<EditCost> costs;  ///< costs of the last finished edits, newest first
    int threads = 1;              ///< number of hardware threads of this machine
};

/// Reads the history. Throws InputError if there is no prior.
EditHistory read_edit_history(StudioStore& store, const StudioFolders& folders);

}  // namespace item3d
