// Routes of uploads: models, painted masks, lights, photographs.
#pragma once

#include "item3d/studio/http.h"

namespace item3d {

void add_upload_routes(StudioRoutes& routes);

}  // namespace item3d
