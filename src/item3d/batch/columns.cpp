#include "item3d/batch/columns.h"

#include "item3d/core/error.h"
#include "item3d/core/names.h"

#include <algorithm>

namespace item3d {

std::string column_named(std::string name, const JobCommand& command, const std::string& subject) {
    std::replace(name.begin(), name.end(), '_', '-');
    if (command.options.contains(name) ||
        std::find(job_columns.begin(), job_columns.end(), name) != job_columns.end())
        return name;
    if (name == "output" || name == "threads" || name == "resume")
        throw InputError(subject, "the column '" + name + "' is set by the batch",
                         "leave it out; the batch sets folder, threads and checkpoint of each job");
    if (name.find(';') != std::string::npos)
        throw InputError(subject, "unknown column '" + name + "'",
                         "separate columns by commas, not by semicolons");
    std::vector<std::string> known = job_columns;
    for (const auto& [option, kind] : command.options)
        known.push_back(option);
    throw InputError(subject, "unknown column '" + name + "'",
                     "did you mean '" + nearest_name(name, known) +
                         "'? Columns are name, command, "
                         "model, after and what item3d " +
                         command.name + " --help lists");
}

}  // namespace item3d
