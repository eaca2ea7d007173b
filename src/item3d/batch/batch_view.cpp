#include "item3d/batch/batch_view.h"

#include "item3d/batch/claim.h"
#include "item3d/core/error.h"
#include "item3d/core/parse_json.h"

namespace item3d {

namespace fs = std::filesystem;
using nlohmann::json;

BatchView::BatchView(const BatchFolder& folder)
    : folder_(folder), jobs_(folder.jobs()), journals_(folder.workers()) {
    refresh();
}

BatchView::News BatchView::refresh() {
    News news;
    for (const std::string& line : jobs_.new_lines()) {
        BatchJob job;
        try {
            const json value = parse_json_or_throw(line);
            if (const auto key = value.find(removed_key); key != value.end()) {
                remove(key->get<std::string>());
                continue;
            }
            value.get_to(job);
        } catch (const json::exception&) {
            throw InputError(folder_.jobs().string(), "contains a line that is not a job",
                             "create the batch again in another folder");
        }
        if (const auto index = add(std::move(job))) news.added.push_back(*index);
    }
    for (const std::string& line : journals_.new_lines()) {
        const json value = parse_json(line);
        if (value.is_discarded()) continue;
        JobEvent event;
        try {
            value.get_to(event);
        } catch (const json::exception&) {
            continue;
        }
        if (take(event)) news.told.push_back(by_id_.at(event.job));
    }
    return news;
}

void BatchView::tell(const JobEvent& event) {
    take(event);
}

/// Adds a job. Returns its index if it becomes current.
std::optional<std::size_t> BatchView::add(BatchJob job) {
    const auto [place, is_new] = by_id_.try_emplace(job.id, entries_.size());
    const std::size_t index = place->second;
    const auto [key, is_new_key] = by_key_.try_emplace(job.key, index);
    if (is_new) {
        entries_.emplace_back();
        entries_.back().job = std::move(job);
    }
    if (!is_new_key && key->second == index) return std::nullopt;
    if (!is_new_key) {
        count(key->second, -1);
        key->second = index;
    }
    count(index, 1);
    return entries_[index].askers == 1 ? std::optional(index) : std::nullopt;
}

void BatchView::remove(const std::string& key) {
    const auto found = by_key_.find(key);
    if (found == by_key_.end()) return;
    count(found->second, -1);
    by_key_.erase(found);
}

void BatchView::count(std::size_t index, int askers) {
    BatchEntry& entry = entries_[index];
    const bool was_open = entry.is_current() && !entry.is_finished();
    entry.askers += askers;
    const bool is_open = entry.is_current() && !entry.is_finished();
    open_ = open_ + (is_open ? 1 : 0) - (was_open ? 1 : 0);
}

bool BatchView::take(const JobEvent& event) {
    const auto found = by_id_.find(event.job);
    if (found == by_id_.end()) return false;
    BatchEntry& entry = entries_[found->second];
    // Journals are read one after another, so a line read later may be older. The number of the
    // attempt decides.
    if (entry.state == JobState::done || event.attempt < entry.last.attempt) return false;
    const bool was_open = entry.is_current() && !entry.is_finished();
    entry.state = event.state;
    entry.last = event;
    const bool is_open = entry.is_current() && !entry.is_finished();
    open_ = open_ + (is_open ? 1 : 0) - (was_open ? 1 : 0);
    return true;
}

std::optional<std::size_t> BatchView::find(const std::string& id) const {
    const auto found = by_id_.find(id);
    return found == by_id_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::size_t> BatchView::find_key(const std::string& key) const {
    const auto found = by_key_.find(key);
    return found == by_key_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::string> BatchView::keys_of(std::size_t index) const {
    std::vector<std::string> keys;
    for (const auto& [key, job] : by_key_)
        if (job == index) keys.push_back(key);
    return keys;
}

std::vector<std::size_t> BatchView::begun() const {
    std::unordered_set<std::string> there;
    std::error_code code;
    for (const auto& shard : fs::directory_iterator(folder_.path() / "runs", code))
        for (const auto& entry : fs::directory_iterator(shard.path(), code))
            there.insert(entry.path().filename().string());
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const BatchEntry& entry = entries_[i];
        const std::string& folder = entry.job.folder;
        if (entry.is_current() && !entry.is_finished() &&
            there.contains(folder.substr(folder.rfind('/') + 1)))
            indices.push_back(i);
    }
    return indices;
}

}  // namespace item3d
