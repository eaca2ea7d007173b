#include "item3d/compare/cases.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<1>(data, size, maximum, seed))

/// Reads a list of cases in JSON or CSV, as the first byte says.
ITEM3D_FUZZ_TARGET(compare_cases, data, size) {
    using namespace item3d;
    if (size == 0) return 0;
    return fuzz::read_or_refuse([&] {
        fuzz::as_file("mug.glb", "glTF");
        auto cases = read_compare_cases(fuzz::as_file(data[0] % 2 ? "cases.csv" : "cases.json",
                                                      fuzz::as_text(data + 1, size - 1)));
        set_defaults(cases, {"iterations=100"});
        for (const CompareCase& each : cases)
            option_arguments(each.options);
    });
}
