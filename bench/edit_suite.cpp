// How good are edits of real meshes that the prior never saw, by numbers and by eye?
//
//   edit_suite -o DIR --mesh cow=spot.obj --mesh object=teapot.obj [--prior DIR] [--only colors]
//
// The demo mug is always among the meshes. Colours, materials for looking at, and stripes, where
// the adjusted direction is beside plain RDL and SDS. (`item3d prior evaluate --mesh` runs the
// wider suite that a prior is judged by.)
#include "item3d/suite/edit_suite.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/hub/find_prior.h"
#include "item3d/suite/models.h"
#include "item3d/tensors/process.h"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace item3d {
namespace {

std::vector<SuiteEdit> chosen_edits(const SuiteOptions& options, const std::string& only) {
    std::vector<std::string> nouns;
    for (const auto& [noun, path] : options.meshes)
        nouns.push_back(noun);
    std::vector<SuiteEdit> edits;
    for (const SuiteCase& test : suite_cases(nouns)) {
        if (!only.empty() && test.group != only) continue;
        edits.push_back({test});
        if (test.group != "stripes") continue;
        edits.push_back({test, "off"});
        edits.push_back({test, "sds"});
    }
    return edits;
}

}  // namespace
}  // namespace item3d

int main(int argc, char** argv) {
    item3d::prepare_process();
    item3d::SuiteOptions options;
    std::vector<std::string> meshes;
    std::string only;
    CLI::App app("Runs the edits that item3d is judged by.");
    app.add_option("-o,--output", options.output, "Folder for all results")->required();
    app.add_option("--prior", options.prior,
                   "Prior, a folder or a name; without it, the embedded one");
    app.add_option("--mesh", meshes, "NOUN=FILE; the demo mug is always there");
    app.add_option("--only", only, "colors, materials or stripes");
    app.add_option("--seed", options.seed, "Seed of the edits");
    app.add_flag("--resume", options.resume, "Keep the edits that an interrupted run has left");
    CLI11_PARSE(app, argc, argv);
    item3d::install_interrupt_handler();
    try {
        options.prior = item3d::find_prior(options.prior.string());
        options.meshes = item3d::suite_meshes(meshes);
        const auto summary = item3d::run_edit_suite(item3d::chosen_edits(options, only), options);
        fmt::print("{}\n", summary["totals"].dump());
    } catch (const item3d::Error& error) {
        fmt::print(stderr, "edit_suite: error: {}\n", error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}
