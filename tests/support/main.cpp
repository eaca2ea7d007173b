// main() of the test programs that use LibTorch. It prepares the process as the item3d programs do.
#include "item3d/tensors/process.h"

#include <gtest/gtest.h>

int main(int argc, char** argv) {
    item3d::prepare_process();
    ::testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
