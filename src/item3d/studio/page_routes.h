// The page itself, who may have it, and what it is told of this machine.
#pragma once

#include "item3d/studio/http.h"

namespace item3d {

void add_page_routes(StudioRoutes& routes);

}  // namespace item3d
