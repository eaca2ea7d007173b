// Command item3d-studio read-model: reads a model for the page, in a process that a broken file may
// crash.
#include "apps/item3d/studio/commands.h"
#include "item3d/studio/model_summary.h"

#include <sys/resource.h>

#include <filesystem>
#include <memory>

namespace item3d {
namespace {

/// Limits the memory, so that a file that unpacks to more is refused.
void limit_memory() {
#if !defined(__SANITIZE_ADDRESS__)  // the address sanitizer needs terabytes of addresses
    constexpr rlim_t maximum = rlim_t{8} << 30;
    const rlimit limit{maximum, maximum};
    ::setrlimit(RLIMIT_AS, &limit);
#endif
}

}  // namespace

void add_read_model_command(CLI::App& app) {
    struct Options {
        std::filesystem::path model, folder;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("read-model", "Read a model for the studio's page");
    command->group("");  // hidden from users
    command->add_option("MODEL", options->model)->required();
    command->add_option("FOLDER", options->folder)->required();
    command->callback([options] {
        limit_memory();
        write_model_summary(options->model, options->folder);
    });
}

}  // namespace item3d
