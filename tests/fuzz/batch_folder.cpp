#include "item3d/batch/batch_view.h"
#include "item3d/batch/status.h"
#include "tests/fuzz/fuzz.h"

/// Reads a batch's folder. The first byte chooses the file that the input replaces: batch.json,
/// jobs, a worker's journal, or a worker's heartbeat.
ITEM3D_FUZZ_TARGET(batch_folder, data, size) {
    using namespace item3d;
    namespace fs = std::filesystem;
    if (size == 0) return 0;
    static const fs::path folder = fuzz::as_file("batch", "").replace_extension("folder");
    static const std::string job =
        R"({"id":"00","key":"k","name":"n","place":"p","command":"edit","model":"/m.glb","model_hash":"","after":"","from":"a","to":"b","arguments":[],"session":"","version":"0","folder":"runs/00/m-00"})";
    static const std::string end =
        R"({"job":"00","state":"failed","worker":"w","attempt":1,"errors":1,"deaths":0,"seconds":2,"message":"","warnings":[],"outcome":null})";
    return fuzz::read_or_refuse([&] {
        for (const char* part : {"jobs", "workers", "runs/00/m-00/attempt-1-w"})
            fs::create_directories(folder / part);
        const std::string content = fuzz::as_text(data + 1, size - 1);
        const auto write = [&](std::size_t number, const char* name, const std::string& usual) {
            std::ofstream(folder / name, std::ios::binary)
                << (data[0] % 4 == number ? content : usual);
        };
        write(0, "batch.json", R"({"format":"item3d batch 1"})");
        write(1, "jobs/000001-0000.jsonl", job + "\n");
        write(2, "workers/w.jsonl", end + "\n");
        write(3, "workers/w.json", R"({"worker":"w","beat":1,"job":"00"})");
        const BatchFolder batch = BatchFolder::open(folder);
        BatchView view(batch);
        const BatchStatus status = status_of(batch, view);
        status_json(status, view);
        status_text(status, view);
    });
}
