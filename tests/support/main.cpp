// main() of the test programs that compute with LibTorch: the process is set up as the programs'
// is.
#include "item3d/tensors/process.h"

#include <gtest/gtest.h>

int main(int argc, char** argv) {
    item3d::prepare_process();
    ::testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
