// Finished runs in a comparison's folder that its table leaves out.
#pragma once

#include "item3d/compare/runs.h"

#include <string>
#include <vector>

namespace item3d {

/// Returns the names of known methods, other than options.methods, of which options.output has
/// finished runs of a case in options.cases.
std::vector<std::string> other_methods(const CompareOptions& options);

/// Prints the names of other_methods(), with the option that adds them.
void note_other_methods(const CompareOptions& options);

}  // namespace item3d
