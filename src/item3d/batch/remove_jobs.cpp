#include "item3d/batch/remove_jobs.h"

#include "item3d/batch/batch_view.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"

#include <filesystem>
#include <map>
#include <set>

namespace item3d {
namespace {

/// Returns the current jobs by each of their names (name, place, folder or id).
std::map<std::string, std::set<std::size_t>> jobs_by_name(const BatchView& view) {
    std::map<std::string, std::set<std::size_t>> jobs;
    for (std::size_t i = 0; i < view.entries().size(); ++i) {
        const BatchEntry& entry = view.entry(i);
        if (!entry.is_current()) continue;
        const std::filesystem::path folder = entry.job.folder;
        for (const std::string& name : {entry.job.name, entry.job.place, entry.job.id,
                                        entry.job.folder, folder.filename().string()})
            if (!name.empty()) jobs[name].insert(i);
    }
    return jobs;
}

std::set<std::size_t> chosen_jobs(const BatchFolder& folder, const BatchView& view,
                                  const std::vector<std::string>& names) {
    const auto known = jobs_by_name(view);
    std::set<std::size_t> chosen;
    for (const std::string& name : names) {
        const auto found = known.find(name);
        if (found != known.end()) {
            chosen.insert(found->second.begin(), found->second.end());
            continue;
        }
        std::vector<std::string> all;
        for (const auto& [other, jobs] : known)
            all.push_back(other);
        throw InputError(folder.path().string(), "has no job '" + name + "'",
                         all.empty() ? "the batch has no jobs"
                                     : "did you mean '" + nearest_name(name, all) + "'");
    }
    return chosen;
}

}  // namespace

std::size_t remove_jobs(const BatchFolder& folder, const std::vector<std::string>& jobs) {
    const BatchView view(folder);
    const std::set<std::size_t> chosen = chosen_jobs(folder, view, jobs);
    std::set<std::string> ids, keys;
    for (const std::size_t index : chosen)
        ids.insert(view.entry(index).job.id);
    for (std::size_t i = 0; i < view.entries().size(); ++i) {
        const BatchEntry& entry = view.entry(i);
        if (!entry.is_current() || chosen.contains(i) || !ids.contains(entry.job.after)) continue;
        throw InputError(folder.path().string(),
                         fmt::format("{} comes after {}", title_of(entry.job),
                                     title_of(view.entry(*view.find(entry.job.after)).job)),
                         "remove both");
    }
    for (const std::string& id : ids)
        for (const std::string& key : view.keys_of(*view.find(id)))
            keys.insert(key);
    folder.remove_jobs({keys.begin(), keys.end()});
    return chosen.size();
}

}  // namespace item3d
