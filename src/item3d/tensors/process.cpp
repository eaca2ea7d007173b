#include "item3d/tensors/process.h"

#include "item3d/tensors/tensor_memory.h"

#include <cstdlib>

namespace item3d {

void prepare_process() {
    // MKL reads this variable at its first matrix product.
    setenv("MKL_CBWR", "AUTO,STRICT", /*overwrite=*/0);
    give_large_tensors_a_region();
}

}  // namespace item3d
