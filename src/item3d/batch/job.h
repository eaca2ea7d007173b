// One job of a batch: an edit or a relighting, with all that decides its result.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

struct BatchJob {
    /// 16 hexadecimal digits of a hash of all that decides the result: the model's content and file
    /// name, or the job before it, the options with the content of the files they name, the prior,
    /// the version.
    std::string id;
    /// What a job is to who asked for it: its name, else its options as written. A later job of the
    /// same key takes the place of the earlier one.
    std::string key;
    std::string name;     ///< of the column `name`; may be empty
    std::string place;    ///< where it was asked for, for messages: "jobs.csv: row 3"
    std::string command;  ///< "edit" or "relight"
    std::string model;    ///< an absolute path; empty with `after`
    /// hash_of_model() when the job was planned; "" where the file was not there, and with `after`.
    std::string model_hash;
    std::string after;  ///< id of the job whose model.glb it reads; may be empty
    std::string from, to;
    std::vector<std::string> arguments;  ///< options of the command, but for model and output
    std::string session;  ///< equal for jobs that run the same networks, which a worker keeps
    std::string version;  ///< of the program that planned it, which alone may run it
    std::string folder;   ///< relative to the batch's: runs/AB/MODEL-SENTENCE-ID
};

void to_json(nlohmann::json& value, const BatchJob& job);
/// Throws nlohmann::json::exception where a member is missing or no text.
void from_json(const nlohmann::json& value, BatchJob& job);

/// runs/AB/SLUG-ID, AB the first two digits of the id: a folder of folders stays short.
std::string job_folder_name(const std::string& id, const std::string& title);

/// How messages call it: the name, else the place.
std::string title_of(const BatchJob& job);

}  // namespace item3d
