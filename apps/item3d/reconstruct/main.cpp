// Program item3d-reconstruct: makes models from photographs.
#include "apps/item3d/reconstruct/commands.h"
#include "apps/item3d/run.h"

int main(int argc, char** argv) {
    item3d::run_program(argc, argv, {item3d::add_reconstruct_command});
}
