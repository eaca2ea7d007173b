// Routes of the page, its access control, and this machine's data.
#pragma once

#include "item3d/studio/http.h"

namespace item3d {

void add_page_routes(StudioRoutes& routes);

}  // namespace item3d
