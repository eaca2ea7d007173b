// Routes of projects: the list, one project, its model, and new results.
#pragma once

#include "item3d/studio/http.h"

namespace item3d {

void add_project_routes(StudioRoutes& routes);

}  // namespace item3d
