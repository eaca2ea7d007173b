// One job of a batch: an edit or a relighting, with everything that its result depends on.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

struct BatchJob {
    /// 16 hexadecimal digits of a hash of everything that the result depends on: the model's
    /// content and file name, or the preceding job; the options and the content of the files that
    /// they name; the prior; the program's version.
    std::string id;
    /// Identity of the job for the user. It is the job's name, or its options as written if it has
    /// no name. A later job with the same key replaces this one.
    std::string key;
    std::string name;     ///< the column `name`; may be empty
    std::string place;    ///< source of the job, for messages: "jobs.csv: row 3"
    std::string command;  ///< "edit" or "relight"
    std::string model;    ///< absolute path; empty if the job has `after`
    /// Hash of the model when the job was planned. It is empty if the file did not exist, or if the
    /// job has `after`.
    std::string model_hash;
    std::string after;  ///< id of the job whose output is the model; may be empty
    std::string from, to;
    std::vector<std::string> arguments;  ///< options of the command except model and output
    std::string session;  ///< equal for jobs with the same networks, which a worker keeps loaded
    /// Version of the program that planned the job; only that version may run it.
    std::string version;
    std::string folder;  ///< relative to the batch's folder: runs/AB/MODEL-SENTENCE-ID
};

void to_json(nlohmann::json& value, const BatchJob& job);
/// Throws nlohmann::json::exception if a member is missing or not a string.
void from_json(const nlohmann::json& value, BatchJob& job);

/// Returns runs/AB/SLUG-ID. AB is the first two digits of the id, so that no folder has many
/// entries.
std::string job_folder_name(const std::string& id, const std::string& title);

/// Returns the job's title for messages: its name, or its place if it has no name.
std::string title_of(const BatchJob& job);

}  // namespace item3d
