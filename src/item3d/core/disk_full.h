// The error of a full disk. It ends a batch's worker, but its job does not count as failed.
#pragma once

#include "item3d/core/error.h"

namespace item3d {

/// Thrown if the disk or the user's quota has no space for a file.
class DiskFull : public ResourceError {
  public:
    using ResourceError::ResourceError;
};

}  // namespace item3d
