// Which guidance method edits best at equal rows of the U-Net? The edit suite with each of them.
//
//   ablation -o DIR --mesh cow=spot.obj --mesh object=teapot.obj [--thin] [--rows 800] [--seeds 3]
//
// Each finished edit leaves a file in DIR/results, and what is there is not done again; several
// processes may work on one folder. What a process was at when it was killed stays in DIR/running
// and is left out until that is removed. The report is of all results that are there.
#include "bench/ablation_edit.h"
#include "bench/ablation_report.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/hub/find_prior.h"
#include "item3d/suite/models.h"
#include "item3d/tensors/process.h"

#include <ATen/Parallel.h>
#include <CLI/CLI.hpp>
#include <omp.h>

#include <algorithm>

namespace item3d {
namespace {

using nlohmann::json;

struct Job {
    Contender contender;
    std::uint64_t seed = 0;
    std::string case_name;
    SuiteCase test;
    std::string name() const { return fmt::format("{}-{}-{}", case_name, contender.name, seed); }
};

/// By name: "00-colors-cow".
std::vector<std::pair<std::string, SuiteCase>> chosen_cases(const AblationOptions& options) {
    std::vector<std::string> nouns;
    for (const auto& [noun, path] : options.meshes)
        nouns.push_back(noun);
    std::vector<std::pair<std::string, SuiteCase>> cases;
    std::map<std::string, int> seen;
    int index = 0;
    for (const SuiteCase& test : suite_cases(nouns)) {
        const int number = seen[test.group]++;
        const int every = test.group == "colors" ? 3 : test.group == "materials" ? 2 : 1;
        if (!options.thin || number % every == 0)
            cases.emplace_back(fmt::format("{:02}-{}-{}", index, test.group, test.mesh), test);
        ++index;
    }
    return cases;
}

/// What matters most comes first, so that an unfinished study says something.
std::vector<Job> jobs(const AblationOptions& options) {
    std::vector<Job> result;
    const auto add = [&](bool first, int seed) {
        for (const auto& [name, test] : chosen_cases(options)) {
            for (const Contender& contender : contenders()) {
                const bool chosen =
                    options.only.empty() || std::find(options.only.begin(), options.only.end(),
                                                      contender.name) != options.only.end();
                if (chosen && contender.first == first)
                    result.push_back({contender, static_cast<std::uint64_t>(seed), name, test});
            }
        }
    };
    for (const bool first : {true, false}) {
        for (int seed = 0; seed < options.seeds; ++seed)
            add(first, seed);
    }
    return result;
}

void run_jobs(const AblationOptions& options) {
    const auto results = options.output / "results", running = options.output / "running";
    make_output_folder(results);
    make_output_folder(running);
    const AblationJudge judge{PriorVocabulary::load(options.prior),
                              Clip::load(find_in_prior(options.prior, "clip"))};
    for (const Job& job : jobs(options)) {
        const auto folder = running / job.name();
        if (std::filesystem::exists(results / (job.name() + ".json"))) continue;
        if (!std::filesystem::create_directory(folder)) continue;  // another process is at it
        json result = run_ablation_edit(job.contender, job.test, job.seed, options, judge, folder);
        result["name"] = job.name();
        result["case"] = job.case_name;
        for (const char* when : {"before", "after"})
            std::filesystem::rename(folder / fmt::format("{}.png", when),
                                    results / fmt::format("{}-{}.png", job.name(), when));
        write_atomically(results / (job.name() + ".json"), result.dump(2) + "\n");
        std::filesystem::remove_all(folder);
        note(fmt::format("{}: directional {:.3f}, kept {:.3f}, {:.0f} s", job.name(),
                         result["directional"].get<double>(), result["kept"].get<double>(),
                         result["seconds"].get<double>()));
    }
}

std::vector<json> finished(const AblationOptions& options) {
    std::vector<json> results;
    for (const Job& job : jobs(options)) {
        const auto path = options.output / "results" / (job.name() + ".json");
        if (std::filesystem::exists(path)) results.push_back(json::parse(read_text(path)));
    }
    return results;
}

}  // namespace
}  // namespace item3d

int main(int argc, char** argv) {
    item3d::prepare_process();
    item3d::AblationOptions options;
    std::vector<std::string> meshes;
    int threads = 1;
    CLI::App app("Compares guidance methods on the edit suite.");
    app.add_option("-o,--output", options.output, "Folder for all results")->required();
    app.add_option("--prior", options.prior, "A folder or a name; without it, the embedded one");
    app.add_option("--mesh", meshes, "NOUN=FILE; the demo mug is always there");
    app.add_option("--rows", options.rows, "Rows of the U-Net for each edit");
    app.add_option("--seeds", options.seeds, "0, 1, ...: so many");
    app.add_option("--only", options.only, "Contenders, by name");
    app.add_option("--threads", threads, "Of each edit");
    app.add_flag("--thin", options.thin, "A third of the colours and half of the materials");
    app.add_flag("--report-only", options.report_only, "Of what is there");
    CLI11_PARSE(app, argc, argv);
    try {
        omp_set_num_threads(threads);
        at::set_num_threads(threads);
        options.prior = item3d::find_prior(options.prior.string());
        options.meshes = item3d::suite_meshes(meshes);
        if (!options.report_only) item3d::run_jobs(options);
        item3d::write_ablation_report(options, item3d::finished(options));
    } catch (const item3d::Error& error) {
        fmt::print(stderr, "ablation: error: {}\n", error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}
