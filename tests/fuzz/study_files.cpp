#include "item3d/study/comparison_table.h"
#include "item3d/study/study.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<1>(data, size, maximum, seed))

/// Reads study.json, or a comparison's table.csv, from which studies are made, as the first byte
/// says.
ITEM3D_FUZZ_TARGET(study_files, data, size) {
    using namespace item3d;
    if (size == 0) return 0;
    return fuzz::read_or_refuse([&] {
        const std::string content = fuzz::as_text(data + 1, size - 1);
        if (data[0] % 2 == 0) {
            const Study study = read_study(fuzz::as_file("study.json", content).parent_path());
            study.fingerprint();
            write_study(study, fuzz::as_file("study.json", content).parent_path());
        } else {
            std::vector<std::string> skipped;
            read_comparison(fuzz::as_file("table.csv", content).parent_path(), skipped);
        }
    });
}
