#include "item3d/compare/compare.h"

#include "item3d/compare/check_cases.h"
#include "item3d/compare/measures.h"
#include "item3d/compare/other_methods.h"
#include "item3d/compare/page.h"
#include "item3d/compare/run_pool.h"
#include "item3d/compare/table.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/io/load_light.h"

namespace item3d {
namespace {

std::vector<CompareRun> finished_runs(std::vector<CompareRun> runs, const CompareOptions& options) {
    const std::size_t planned = runs.size();
    std::erase_if(runs, [](const CompareRun& run) { return !is_done(run); });
    if (runs.empty())
        throw InputError(options.output.string(), "none of its runs has finished",
                         "leave out --table-only to start them");
    note(fmt::format("{} of {} have finished", runs.size(), counted(planned, "run")));
    return runs;
}

}  // namespace

nlohmann::json compare_methods(const CompareOptions& options, const std::string& command) {
    for (const std::string& light : options.images.lights)
        load_light(light);  // throws now, not after hours of computing
    check_cases(options);
    make_output_folder(options.output);
    std::vector<CompareRun> runs = plan_runs(options);
    if (options.table_only)
        runs = finished_runs(std::move(runs), options);
    else
        perform_runs(runs, options);
    note_other_methods(options);
    std::vector<nlohmann::json> rows;
    std::size_t failed = 0;
    for (const CompareRun& run : runs) {
        if (interrupted())
            throw Interrupted(
                "all runs have ended; run the same command again to measure them and "
                "to write the table and the page");
        const CompareCase& test = options.cases[run.case_index];
        nlohmann::json row;
        try {
            row = measured_run(run, test, options.images);
        } catch (const Error& error) {
            if (error.code() == ExitCode::interrupted) throw;
            row = row_of(run, test);
            row["error"] = fmt::format("cannot be measured: {}", error.what());
        } catch (const nlohmann::json::exception&) {
            row = row_of(run, test);
            row["error"] = "its edit.json lacks a value; delete the run's folder to run it again";
        }
        if (row.contains("error")) ++failed;
        rows.push_back(std::move(row));
    }
    write_atomically(options.output / "table.csv", table_csv(rows));
    write_atomically(options.output / "table.tex", table_latex(rows));
    write_atomically(options.output / "index.html", compare_page(rows, options.output, command));
    return {{"runs", rows.size()}, {"failed", failed}, {"rows", rows}};
}

}  // namespace item3d
