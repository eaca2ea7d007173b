#include "item3d/batch/plan_jobs.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<1>(data, size, maximum, seed))

/// Plans the jobs of a CSV, JSON or JSON Lines file, which the first byte chooses. Each job must be
/// the same after it was written as a line of a batch and read again.
ITEM3D_FUZZ_TARGET(job_plan, data, size) {
    using namespace item3d;
    if (size == 0) return 0;
    const char* const names[] = {"plan.csv", "plan.json", "plan.jsonl"};
    const JobPlanning planning{{{"edit",
                                 {{"from", ColumnKind::single},
                                  {"to", ColumnKind::single},
                                  {"seed", ColumnKind::single},
                                  {"region", ColumnKind::repeated},
                                  {"timesteps", ColumnKind::commas},
                                  {"light", ColumnKind::single},
                                  {"prior", ColumnKind::single},
                                  {"allow-missing-textures", ColumnKind::flag}},
                                 {"from", "to"},
                                 {"plan"}},
                                {"relight", {{"light", ColumnKind::single}}, {}, {}}},
                               "1.0",
                               [](const std::string& prior) { return "weights of " + prior; },
                               [](const std::string&, const std::vector<std::string>&) {},
                               {}};
    return fuzz::read_or_refuse([&] {
        const auto file = fuzz::as_file(names[data[0] % 3], fuzz::as_text(data + 1, size - 1));
        for (const BatchJob& job : plan_jobs(read_job_rows(file), planning)) {
            const BatchJob same = nlohmann::json(job).get<BatchJob>();
            ITEM3D_CHECK(same.id == job.id && same.folder == job.folder,
                         "a job is read as written");
        }
    });
}
