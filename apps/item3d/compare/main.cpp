// Program item3d-compare: compares methods side by side.
#include "apps/item3d/compare/commands.h"
#include "apps/item3d/run.h"

int main(int argc, char** argv) {
    item3d::run_program(argc, argv, {item3d::add_compare_command});
}
