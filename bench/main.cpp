// main() of the benchmark programs, each of which measures one folder of src/item3d.
#include "item3d/tensors/process.h"

#include <benchmark/benchmark.h>

int main(int argc, char** argv) {
    item3d::prepare_process();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
