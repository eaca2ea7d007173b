// Planning of jobs from rows: names, paths, order and identity.
#pragma once

#include "item3d/batch/columns.h"
#include "item3d/batch/job.h"
#include "item3d/batch/job_rows.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace item3d {

struct JobPlanning {
    std::vector<JobCommand> commands;  ///< the first is for rows without a command
    std::string version;
    /// Identity of the prior: its weights and settings, by the value of the option `prior`, ""
    /// without one. Throws InputError.
    std::function<std::string(const std::string& prior)> prior_identity;
    /// Throws an Error if the command would refuse its arguments.
    std::function<void(const std::string& command, const std::vector<std::string>& arguments)>
        check;
    /// Ids of named jobs already in the batch, for `after`.
    std::map<std::string, std::string> known_names;
};

/// Returns the jobs of the rows, ordered so that each follows its predecessor. In sentences {name}
/// stands for the model's file name without extension, with spaces for - and _. Relative paths
/// start at the row's folder. Duplicate jobs are merged with a note. Throws InputError that names
/// the row: an unknown column or command, neither model nor after, a duplicate name, an `after`
/// that names no job, or a cycle of them, with its jobs.
std::vector<BatchJob> plan_jobs(const std::vector<JobRow>& rows, const JobPlanning& planning);

}  // namespace item3d
