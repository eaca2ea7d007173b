#include "item3d/studio/http.h"
#include "item3d/studio/records.h"
#include "item3d/studio/store.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<1>(data, size, maximum, seed))

namespace {

/// A studio's database with one project and one result.
struct FuzzedRecords {
    std::filesystem::path folder = item3d::fuzz::as_file("records", "").replace_extension("folder");
    item3d::StudioStore store{(std::filesystem::create_directories(folder), folder)};
    std::int64_t project = store.add_project("mug");
    std::int64_t result = store.add_result(new_result(project)).id;
    item3d::Sqlite database{folder / "studio.sqlite", false};

    static item3d::StudioResult new_result(std::int64_t project) {
        item3d::StudioResult result;
        result.project = project;
        return result;
    }
};

}  // namespace

/// Reads a project and a result of the studio's database. The first byte chooses the column that
/// the input replaces.
ITEM3D_FUZZ_TARGET(studio_records, data, size) {
    using namespace item3d;
    static constexpr const char* columns[] = {"request", "scores", "files", "state",  "kind",
                                              "name",    "parent", "note",  "created"};
    static FuzzedRecords fuzzed;
    if (size == 0) return 0;
    return fuzz::read_or_refuse([&] {
        const std::string content = fuzz::as_text(data + 1, size - 1);
        const std::size_t column = data[0] % (std::size(columns) + 1);
        SqliteTransaction transaction(fuzzed.database);
        SqliteRows rows(fuzzed.database,
                        column < std::size(columns)
                            ? std::string("UPDATE results SET ") + columns[column] + " = ?"
                            : "UPDATE projects SET model = ?");
        rows.bind(content);
        rows.next();
        transaction.commit();
        for (const StudioResult& result : fuzzed.store.results(fuzzed.project))
            result_json(result).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
        if (const auto project = fuzzed.store.project(fuzzed.project))
            project_json(*project).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    });
}
