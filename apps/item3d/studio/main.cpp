// Program item3d-studio: serves edits to browsers and agents.
#include "apps/item3d/program.h"
#include "apps/item3d/studio/commands.h"

#include <csignal>

int main(int argc, char** argv) {
    // A file at its size limit, and a disconnected browser, must be errors of write().
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    item3d::end_program(item3d::guarded([&] {
        return item3d::parse_and_run(
            argc, argv,
            {item3d::add_studio_command, item3d::add_mcp_command, item3d::add_read_model_command});
    }));
}
