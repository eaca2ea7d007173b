// Routes of results: actions on them, and their files.
#pragma once

#include "item3d/studio/http.h"

namespace item3d {

void add_result_routes(StudioRoutes& routes);

}  // namespace item3d
