// Program item3d-bench: measures speed.
#include "apps/item3d/bench/commands.h"
#include "apps/item3d/run.h"

int main(int argc, char** argv) {
    item3d::run_program(argc, argv, {item3d::add_bench_command});
}
