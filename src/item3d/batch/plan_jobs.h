// Jobs of rows: names, paths, order and identity.
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
    std::vector<JobCommand> commands;  ///< the first is that of rows without a command
    std::string version;
    /// What decides a result besides the job: the prior's weights and settings. By the value of the
    /// option `prior`, "" where there is none. Throws InputError.
    std::function<std::string(const std::string& prior)> prior_identity;
    /// Throws an Error where the command would refuse its arguments.
    std::function<void(const std::string& command, const std::vector<std::string>& arguments)>
        check;
    /// Named jobs that are in the batch already, for `after`: their ids.
    std::map<std::string, std::string> known_names;
};

/// The jobs of these rows, in an order in which a job stands behind the one that it comes after. In
/// sentences {name} stands for the model's file name without its extension, with spaces for - and
/// _. Relative paths begin at the row's folder. A job that is there twice is there once, with a
/// note. Throws InputError that names the row: an unknown column or command, neither model nor
/// after, a name that is there twice, an `after` that names no job, or a cycle of them, with the
/// jobs in it.
std::vector<BatchJob> plan_jobs(const std::vector<JobRow>& rows, const JobPlanning& planning);

}  // namespace item3d
