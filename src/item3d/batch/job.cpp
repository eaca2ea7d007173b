#include "item3d/batch/job.h"

#include "item3d/core/names.h"

namespace item3d {

void to_json(nlohmann::json& value, const BatchJob& job) {
    value = {{"id", job.id},           {"key", job.key},         {"place", job.place},
             {"command", job.command}, {"version", job.version}, {"folder", job.folder}};
    // Empty members are omitted, because a batch may have a hundred thousand jobs.
    const auto add = [&](const char* key, const auto& member) {
        if (!member.empty()) value[key] = member;
    };
    add("name", job.name);
    add("model", job.model);
    add("model_hash", job.model_hash);
    add("after", job.after);
    add("from", job.from);
    add("to", job.to);
    add("arguments", job.arguments);
    add("session", job.session);
}

void from_json(const nlohmann::json& value, BatchJob& job) {
    const std::string none;
    value.at("id").get_to(job.id);
    value.at("key").get_to(job.key);
    value.at("place").get_to(job.place);
    value.at("command").get_to(job.command);
    value.at("version").get_to(job.version);
    value.at("folder").get_to(job.folder);
    job.name = value.value("name", none);
    job.model = value.value("model", none);
    job.model_hash = value.value("model_hash", none);
    job.after = value.value("after", none);
    job.from = value.value("from", none);
    job.to = value.value("to", none);
    job.arguments = value.value("arguments", std::vector<std::string>());
    job.session = value.value("session", none);
}

std::string job_folder_name(const std::string& id, const std::string& title) {
    return "runs/" + id.substr(0, 2) + "/" + slug(title) + "-" + id;
}

std::string title_of(const BatchJob& job) {
    return job.name.empty() ? job.place : job.name;
}

}  // namespace item3d
