#include "item3d/batch/retry.h"

#include "item3d/batch/claim.h"
#include "item3d/batch/process_mark.h"
#include "item3d/batch/status.h"
#include "item3d/core/format.h"

#include <unistd.h>

namespace item3d {

std::size_t retry_failed_jobs(const BatchFolder& folder) {
    BatchView view(folder);
    std::size_t count = 0;
    const std::string journal = fmt::format("{}-{}-{}", host_name(), ::getpid(), random_suffix());
    for (const std::size_t index : status_of(folder, view).failures) {
        const BatchEntry& entry = view.entry(index);
        if (!retry_failed(folder.folder_of(entry.job), entry.last.attempt)) continue;
        JobEvent event = entry.last;
        event.state = JobState::waiting;
        event.worker = journal;
        event.errors = event.deaths = 0;
        event.message.clear();
        ++event.attempt;
        append_line(folder.workers() / (journal + ".jsonl"), nlohmann::json(event).dump());
        ++count;
    }
    return count;
}

}  // namespace item3d
