// The error of a full disk, which ends a worker without failing its job.
#pragma once

#include "item3d/core/error.h"

namespace item3d {

/// No space, or no quota, for a file.
class DiskFull : public ResourceError {
  public:
    using ResourceError::ResourceError;
};

}  // namespace item3d
