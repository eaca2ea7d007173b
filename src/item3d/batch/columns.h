// Columns of jobs: the options of the commands that jobs run.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Syntax of an option's values.
enum class ColumnKind {
    flag,      ///< no value: the column is true or false
    single,    ///< one value
    repeated,  ///< several values, each after a repeated option
    commas     ///< several values separated by commas
};

struct JobCommand {
    std::string name;  ///< "edit" or "relight"
    /// Options by long name without the leading dashes.
    std::map<std::string, ColumnKind> options;
    /// Options that a job must have, unless it has one of the options in `instead`.
    std::vector<std::string> required;
    std::vector<std::string> instead;
};

/// Columns that are not options.
inline const std::vector<std::string> job_columns = {"name", "command", "model", "after"};

/// Returns the command's option for a column; underscores in the column's name stand for dashes.
/// Throws InputError for an unknown column. The message has `subject`, the column and the most
/// similar known column.
std::string column_named(std::string name, const JobCommand& command, const std::string& subject);

}  // namespace item3d
