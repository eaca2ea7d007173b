// Program make_demo FILE.glb: writes the demo model that `make demo` edits.
#include "apps/make_demo/mug.h"
#include "item3d/core/error.h"
#include "item3d/io/save.h"

#include <cstdio>
#include <exception>

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: make_demo FILE.glb\n");
        return static_cast<int>(item3d::ExitCode::usage);
    }
    try {
        item3d::save_model(argv[1], item3d::demo::make_mug(1024));
        return 0;
    } catch (const item3d::Error& error) {
        std::fprintf(stderr, "make_demo: %s\n", error.what());
        return static_cast<int>(error.code());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make_demo: %s\n", error.what());
        return static_cast<int>(item3d::ExitCode::bug);
    }
}
