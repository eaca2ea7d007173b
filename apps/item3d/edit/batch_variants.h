// The implementation of `item3d batch --variants`, which writes the edits of each model as variants
// in one file.
#pragma once

#include "item3d/batch/batch_folder.h"
#include "item3d/batch/batch_view.h"

#include <filesystem>
#include <vector>

namespace item3d {

/// Writes variants/MODEL.glb into the batch's folder for each model with finished edits. The file
/// has these edits as variants, in the order of the jobs. Leaves out jobs with a predecessor
/// (`after`), because they start from another model. Warns of a model whose edits cannot share one
/// file. Returns the files.
std::vector<std::filesystem::path> write_batch_variants(const BatchFolder& folder,
                                                        const BatchView& view);

}  // namespace item3d
