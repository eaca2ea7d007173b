#include "item3d/studio/live_folder.h"

#include "item3d/studio/job_clock.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<1>(data, size, maximum, seed))

/// Reads the progress of a running command, or the list of its live textures, as the first byte
/// says, and uses the values as the studio does.
ITEM3D_FUZZ_TARGET(live_folder, data, size) {
    using namespace item3d;
    if (size == 0) return 0;
    return fuzz::read_or_refuse([&] {
        const std::string content = fuzz::as_text(data + 1, size - 1);
        const char* name = data[0] % 2 == 0 ? progress_file_name : textures_file_name;
        LiveFolder live(fuzz::as_file(name, content).parent_path());
        if (data[0] % 2 == 0) {
            JobClock clock({1, 2, 3, 4});
            if (const auto progress = live.new_progress()) clock.seconds_left(*progress, 1);
        } else if (const auto preview = live.new_preview()) {
            for (const auto& texture : preview->at("textures"))
                live_texture_url(1, texture.at("file"), preview->at("revision"));
        }
    });
}
