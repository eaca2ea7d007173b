// Program item3d-study: runs user studies of edits.
#include "apps/item3d/run.h"
#include "apps/item3d/study/commands.h"

int main(int argc, char** argv) {
    item3d::run_program(argc, argv, {item3d::add_study_command});
}
