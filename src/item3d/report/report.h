// The page that an edit leaves behind: report.html, self-contained.
#pragma once

#include "item3d/report/html.h"
#include "item3d/report/html_chart.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// One texture of a material, as it was and as it became; either may be without bytes.
struct TexturePair {
    std::string name;  ///< "Base colour", "Roughness", ...
    Bytes before;
    Bytes after;
};

/// A number that matters, with a word on what it means.
struct Score {
    std::string name;
    std::string value;
    std::string meaning;
};

/// How the edit stood at one moment.
struct TimelineEntry {
    std::string title;  ///< when
    ReportImage picture;
    std::string caption;                                     ///< what was seen; may be empty
    std::vector<std::pair<std::string, std::string>> facts;  ///< names and numbers
};

struct EditReport {
    std::string model;  ///< its file's name
    std::string from;
    std::string to;
    std::string summary;  ///< one plain sentence below the two; may be empty
    /// Pictures of the same views; before[i] and after[i] show the same camera.
    std::vector<ReportImage> before;
    std::vector<ReportImage> after;
    std::vector<ReportImage> region;  ///< views that show what was to change; none: all of it
    std::string region_note;
    std::optional<ReportImage> turntable;
    std::vector<TexturePair> textures;
    std::vector<Score> scores;
    std::vector<TimelineEntry> timeline;  ///< in order
    std::string timeline_note;            ///< what its numbers mean
    std::vector<Chart> charts;
    TableRows settings;
    std::vector<std::pair<std::string, double>> seconds;  ///< by stage
    std::vector<std::string> warnings;
    /// Label and path relative to the report: {"model.glb", "model.glb"}. The first stands out.
    std::vector<std::pair<std::string, std::string>> files;
    std::string command;  ///< the line that repeats the edit
    std::string version;
};

std::string edit_report_html(const EditReport& report);

}  // namespace item3d
