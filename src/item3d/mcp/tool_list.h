// List of the tools offered to agents.
#pragma once

#include "item3d/mcp/tool.h"

namespace item3d {

const std::vector<Tool>& tools();

}  // namespace item3d
