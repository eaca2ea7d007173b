// Projects: the list, one, its model, and what is made of it.
#pragma once

#include "item3d/studio/http.h"

namespace item3d {

void add_project_routes(StudioRoutes& routes);

}  // namespace item3d
