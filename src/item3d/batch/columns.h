// Which columns jobs may have: the options of the commands that jobs run.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace item3d {

/// How an option takes values.
enum class ColumnKind {
    flag,      ///< none: the column is true or false
    single,    ///< one
    repeated,  ///< several, each behind the option once more
    commas     ///< several with commas
};

struct JobCommand {
    std::string name;  ///< "edit" or "relight"
    /// By the option's long name without dashes.
    std::map<std::string, ColumnKind> options;
    /// Options that a job must have, where it has none of `instead`.
    std::vector<std::string> required;
    std::vector<std::string> instead;
};

/// Columns beside the options.
inline const std::vector<std::string> job_columns = {"name", "command", "model", "after"};

/// The command's option that a column means; underscores stand for dashes. Throws InputError that
/// names `subject`, the column and the nearest one that there is.
std::string column_named(std::string name, const JobCommand& command, const std::string& subject);

}  // namespace item3d
