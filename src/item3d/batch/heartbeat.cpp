#include "item3d/batch/heartbeat.h"

#include "item3d/batch/process_mark.h"
#include "item3d/core/format.h"

#include <unistd.h>

#include <cstdio>
#include <fstream>

namespace item3d {

Heartbeat::Heartbeat(const BatchFolder& folder, std::chrono::milliseconds every)
    : worker_(fmt::format("{}-{}-{}", host_name(), ::getpid(), random_suffix())),
      every_(every),
      process_(this_process()) {
    file_ = folder.workers() / (worker_ + ".json");
    write(false);
    thread_ = std::thread([this] { beat_on(); });
}

Heartbeat::~Heartbeat() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
    job_.clear();
    write(true);
}

void Heartbeat::set_job(const std::string& id) {
    const std::lock_guard lock(mutex_);
    job_ = id;
    write(false);
}

void Heartbeat::beat_on() {
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, every_, [this] { return stop_; }))
        write(false);
}

void Heartbeat::write(bool ended) {
    ++beat_;
    const nlohmann::json state = {{"worker", worker_},
                                  {"beat", beat_},
                                  {"job", job_},
                                  {"process", process_},
                                  {"ended", ended}};
    // write_atomically() is not used, because a heartbeat need not survive a power cut, and must
    // not wait for the disk.
    const std::filesystem::path temporary = file_.string() + ".tmp";
    {
        std::ofstream file(temporary, std::ios::trunc);
        file << state.dump() << '\n';
        if (!file.flush()) return;
    }
    std::error_code ignored;
    std::filesystem::rename(temporary, file_, ignored);
}

}  // namespace item3d
