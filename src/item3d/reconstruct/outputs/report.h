// report.html of a reconstruction.
#pragma once

#include "item3d/reconstruct/outputs/outputs.h"

#include <string>

namespace item3d {

/// report.html, self-contained.
std::string report_html(const Reconstruction& result);

}  // namespace item3d
