// Command item3d prior pull: downloads a prior from the Hugging Face hub into its cache.
#include "apps/item3d/command.h"
#include "apps/item3d/train/prior_commands.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/hub/cache.h"
#include "item3d/hub/pull.h"

#include <memory>
#include <string>

namespace item3d {
namespace {

struct PullOptions : CommonOptions {
    std::string repository;
    std::string revision;
    std::string variant;
};

void run_pull(const PullOptions& options) {
    const auto name = RepositoryName::parse(options.repository);
    if (!name) throw UsageError(options.repository + ": expected org/name, or org/name@revision");
    if (!name->revision.empty() && !options.revision.empty())
        throw UsageError("--revision: " + options.repository + " already contains a revision");
    PullRequest request = PullRequest::from_environment();
    request.repository = name->name;
    request.revision = options.revision.empty() ? name->revision_or_main() : options.revision;
    if (!is_revision(request.revision))
        throw UsageError("--revision " + request.revision + ": expected a branch, tag or commit");
    request.variant = options.variant;

    const PullResult result = pull(request);
    if (options.json) {
        print_json({{"repository", request.repository},
                    {"revision", request.revision},
                    {"commit", result.commit},
                    {"folder", result.folder.string()},
                    {"files", result.files},
                    {"bytes", result.bytes},
                    {"downloaded_bytes", result.downloaded_bytes}});
    } else {
        note(fmt::format("pull: {} of {} at {}, {:.1f} MB in {} files, {:.1f} MB of them new",
                         request.revision, request.repository, result.commit,
                         static_cast<double>(result.bytes) / 1e6, result.files.size(),
                         static_cast<double>(result.downloaded_bytes) / 1e6));
        fmt::print("{}\n", result.folder.string());
    }
}

}  // namespace

void add_prior_pull(CLI::App& prior) {
    auto options = std::make_shared<PullOptions>();
    CLI::App* command = add_command(
        prior, "pull", "Download a prior from the Hugging Face hub into the local cache", *options);
    command->add_option("REPOSITORY", options->repository, "org/name, or org/name@revision")
        ->required();
    command
        ->add_option("--revision", options->revision,
                     "Branch, tag or commit. Default: the main branch")
        ->type_name("NAME");
    command
        ->add_option("--variant", options->variant,
                     "Variant of the weights: fp16 has half the size, if the repository has it")
        ->check(CLI::IsMember({"fp16"}));
    command->footer(
        "HF_TOKEN, HF_HOME, HF_HUB_CACHE and HF_ENDPOINT are used as by huggingface_hub.");
    command->callback([options] {
        start_command(*options);
        run_pull(*options);
    });
}

}  // namespace item3d
