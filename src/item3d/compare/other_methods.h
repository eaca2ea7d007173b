// The finished runs in a comparison's folder that its table leaves out.
#pragma once

#include "item3d/compare/runs.h"

#include <string>
#include <vector>

namespace item3d {

/// Returns the names of methods that are not in options.methods but have finished runs in
/// options.output, for a case in options.cases.
std::vector<std::string> other_methods(const CompareOptions& options);

/// Prints the names of other_methods(), and the option that adds them to the table.
void note_other_methods(const CompareOptions& options);

}  // namespace item3d
