// Program item3d-train: trains, fetches and inspects priors.
#include "apps/item3d/run.h"
#include "apps/item3d/train/commands.h"

int main(int argc, char** argv) {
    item3d::run_program(argc, argv, {item3d::add_prior_command});
}
