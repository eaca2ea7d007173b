// The error of a full disk, which ends a worker without failing its job.
#pragma once

#include "item3d/core/error.h"

namespace item3d {

/// Error: the disk or the user's quota has no space for a file.
class DiskFull : public ResourceError {
  public:
    using ResourceError::ResourceError;
};

}  // namespace item3d
