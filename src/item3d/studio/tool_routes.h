// Routes of tools that reply at once, for lights, regions, layers and estimates.
#pragma once

#include "item3d/studio/http.h"

namespace item3d {

void add_tool_routes(StudioRoutes& routes);

}  // namespace item3d
