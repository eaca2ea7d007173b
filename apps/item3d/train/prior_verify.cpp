// Command item3d prior verify: lists a prior's parts and checks that an edit can use it.
#include "apps/item3d/command.h"
#include "apps/item3d/train/prior_commands.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/hub/find_prior.h"
#include "item3d/networks/verify.h"

#include <memory>
#include <string>

namespace item3d {
namespace {

struct VerifyOptions : CommonOptions {
    std::string prior;
};

std::string readable(std::uint64_t bytes) {
    return bytes < 1'000'000'000 ? fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6)
                                 : fmt::format("{:.2f} GB", static_cast<double>(bytes) / 1e9);
}

nlohmann::json to_json(const PriorReport& report) {
    nlohmann::json parts = nlohmann::json::object();
    for (const PartReport& part : report.parts)
        parts[part.name] = {{"class", part.class_name},
                            {"parameters", part.parameters},
                            {"stored_as", part.stored_as},
                            {"file_bytes", part.file_bytes}};
    nlohmann::json memory = nlohmann::json::object();
    for (const MemoryReport& entry : report.memory)
        memory[entry.precision] = {{"weights", entry.weights},
                                   {"edit_peak_estimate", entry.edit_peak_estimate()}};
    return {{"folder", report.folder},
            {"pipeline", report.pipeline_class},
            {"usable", report.usable()},
            {"problems", report.problems},
            {"parts", parts},
            {"parameters", report.parameters()},
            {"memory", memory},
            {"resolution", report.resolution},
            {"condition_channels", report.condition_channels},
            {"prediction_type", report.prediction_type}};
}

void print_report(const PriorReport& report) {
    fmt::print("{}\n{}", report.folder, report.pipeline_class);
    if (report.resolution > 0) fmt::print(", {0} x {0} pixels", report.resolution);
    if (!report.prediction_type.empty()) fmt::print(", predicts {}", report.prediction_type);
    if (report.condition_channels == 1) fmt::print(", takes depth");
    if (report.condition_channels > 1) fmt::print(", takes depth, position and normal");
    fmt::print("\n\n");
    for (const PartReport& part : report.parts) {
        fmt::print("  {:16} {:28}", part.name, part.class_name);
        if (part.parameters > 0)
            fmt::print(" {:9.2f} M parameters  {} as {}",
                       static_cast<double>(part.parameters) / 1e6, readable(part.file_bytes),
                       part.stored_as);
        fmt::print("\n");
    }
    if (!report.memory.empty()) fmt::print("\n");
    for (const MemoryReport& memory : report.memory)
        fmt::print("  {}: {} of weights; estimated peak memory of an edit {}\n", memory.precision,
                   readable(memory.weights), readable(memory.edit_peak_estimate()));
    if (report.usable()) fmt::print("\nusable\n");
}

void run_verify(const VerifyOptions& options) {
    const PriorReport report = verify_prior(find_prior(options.prior));
    if (options.json)
        print_json(to_json(report));
    else
        print_report(report);
    if (report.usable()) return;
    if (!options.json) {
        fmt::print("\n");
        for (const std::string& problem : report.problems)
            fmt::print("problem: {}\n", problem);
    }
    std::fflush(stdout);
    throw InputError(report.folder,
                     fmt::format("cannot be used as a prior: {} problem{}", report.problems.size(),
                                 report.problems.size() == 1 ? "" : "s"));
}

}  // namespace

void add_prior_verify(CLI::App& prior) {
    auto options = std::make_shared<VerifyOptions>();
    CLI::App* command = add_command(
        prior, "verify", "Show the networks of a prior and check whether it can be used", *options);
    command->add_option("PRIOR", options->prior,
                        "Folder or name of the prior. Default: the embedded prior");
    command->callback([options] {
        start_command(*options);
        run_verify(*options);
    });
}

}  // namespace item3d
