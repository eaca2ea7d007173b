#include "item3d/compare/other_methods.h"

#include "item3d/baselines/methods.h"
#include "item3d/compare/suites.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"
#include "item3d/core/progress.h"

#include <algorithm>
#include <system_error>

namespace item3d {
namespace {

std::vector<std::string> known_methods() {
    std::vector<std::string> names = edit_method_names();
    for (const CompareSuite& suite : compare_suites(1))
        for (const CompareMethod& method : suite.methods)
            if (std::find(names.begin(), names.end(), method.name) == names.end())
                names.push_back(method.name);
    return names;
}

/// Returns the part CASE-METHOD of a run's folder name, CASE-METHOD-SEED-HASH.
std::string without_seed(std::string name) {
    for (int part = 0; part < 2; ++part)
        name.resize(std::min(name.rfind('-'), name.size()));
    return name;
}

}  // namespace

std::vector<std::string> other_methods(const CompareOptions& options) {
    std::vector<std::string> finished;
    std::error_code ignored;
    for (const auto& entry :
         std::filesystem::directory_iterator(options.output / "runs", ignored)) {
        CompareRun run;
        run.folder = entry.path();
        if (is_done(run)) finished.push_back(without_seed(entry.path().filename().string()));
    }
    std::vector<std::string> others;
    for (const std::string& method : known_methods()) {
        if (std::any_of(options.methods.begin(), options.methods.end(),
                        [&](const CompareMethod& one) { return one.name == method; }))
            continue;
        const bool has_run =
            std::any_of(options.cases.begin(), options.cases.end(), [&](const CompareCase& test) {
                return std::find(finished.begin(), finished.end(),
                                 slug(test.name) + "-" + slug(method)) != finished.end();
            });
        if (has_run) others.push_back(method);
    }
    return others;
}

void note_other_methods(const CompareOptions& options) {
    const std::vector<std::string> others = other_methods(options);
    if (others.empty()) return;
    note(
        fmt::format("runs of {} are kept but are not in this table; add them with --methods "
                    "(all methods of the table each time)",
                    fmt::join(others, ", ")));
}

}  // namespace item3d
