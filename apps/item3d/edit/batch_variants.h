// item3d batch --variants: the edits of each model as looks of one file.
#pragma once

#include "item3d/batch/batch_folder.h"
#include "item3d/batch/batch_view.h"

#include <filesystem>
#include <vector>

namespace item3d {

/// Writes variants/MODEL.glb into the batch's folder for each model of which edits are done, with
/// those edits in the order in which they were asked for. Jobs `after` others are of another model
/// and left out. A model whose edits cannot share one file is a warning. Returns the files.
std::vector<std::filesystem::path> write_batch_variants(const BatchFolder& folder,
                                                        const BatchView& view);

}  // namespace item3d
