#include "item3d/batch/job_rows.h"

#include "tests/fuzz/fuzz.h"

/// Reads rows of jobs. The first byte chooses one of the three kinds of files.
ITEM3D_FUZZ_TARGET(job_rows, data, size) {
    using namespace item3d;
    if (size == 0) return 0;
    const char* const names[] = {"jobs.csv", "jobs.json", "jobs.jsonl"};
    return fuzz::read_or_refuse([&] {
        read_job_rows(fuzz::as_file(names[data[0] % 3], fuzz::as_text(data + 1, size - 1)));
    });
}
