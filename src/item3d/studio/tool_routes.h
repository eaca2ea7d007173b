// Routes of tools that reply at once: lights, regions, layers, estimates.
#pragma once

#include "item3d/studio/http.h"

namespace item3d {

void add_tool_routes(StudioRoutes& routes);

}  // namespace item3d
