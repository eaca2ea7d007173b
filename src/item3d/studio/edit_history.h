// What edits took on this machine, for estimates of others.
#pragma once

#include "item3d/studio/estimate.h"
#include "item3d/studio/folders.h"
#include "item3d/studio/store.h"

#include <nlohmann/json.hpp>

#include <vector>

namespace item3d {

struct EditHistory {
    nlohmann::json defaults;      ///< settings of the shipped prior
    std::vector<EditCost> costs;  ///< of the last edits that are done, the latest first
    int threads = 1;              ///< of this machine
};

/// Throws InputError where there is no prior.
EditHistory read_edit_history(StudioStore& store, const StudioFolders& folders);

}  // namespace item3d
