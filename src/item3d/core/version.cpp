#include "item3d/core/version.h"

namespace item3d {

std::string version() {
    return ITEM3D_VERSION;
}

}  // namespace item3d
