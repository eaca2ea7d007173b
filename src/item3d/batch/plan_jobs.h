// The planning of jobs from rows. It determines each job's name, paths, place in the order, and
// identity.
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
    std::vector<JobCommand> commands;  ///< the known commands; the first is the default
    std::string version;
    /// Returns the identity of a prior, a text that depends on its weights and settings. prior:
    /// value of the option `prior`, or "" if the option is not given. Throws InputError.
    std::function<std::string(const std::string& prior)> prior_identity;
    /// Throws an Error if the command would refuse its arguments.
    std::function<void(const std::string& command, const std::vector<std::string>& arguments)>
        check;
    /// Ids of the named jobs that the batch already has, by name. The column `after` may name these
    /// jobs.
    std::map<std::string, std::string> known_names;
};

/// Returns the jobs of the rows, ordered so that each follows its predecessor. In sentences, {name}
/// is replaced by the model's file name without extension, with spaces in place of "-" and "_".
/// Relative paths start at the row's folder. Duplicate jobs are merged with a note. Throws
/// InputError that names the row for an unknown column or command, a row with neither `model` nor
/// `after`, a duplicate name, an `after` that names no job, or a cycle of predecessors, whose jobs
/// the message lists.
std::vector<BatchJob> plan_jobs(const std::vector<JobRow>& rows, const JobPlanning& planning);

}  // namespace item3d
