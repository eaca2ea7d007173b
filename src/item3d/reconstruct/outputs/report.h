// HTML report of a reconstruction, report.html.
#pragma once

#include "item3d/reconstruct/outputs/outputs.h"

#include <string>

namespace item3d {

/// Returns a self-contained report.html.
std::string report_html(const Reconstruction& result);

}  // namespace item3d
