// Self-contained report of an edit, report.html.
#pragma once

#include "item3d/report/html.h"
#include "item3d/report/html_chart.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Texture of a material before and after the edit. Either may be empty.
struct TexturePair {
    std::string name;  ///< "Base colour", "Roughness", ...
    Bytes before;
    Bytes after;
};

/// Named number with its meaning.
struct Score {
    std::string name;
    std::string value;
    std::string meaning;
};

/// State of the edit at one moment.
struct TimelineEntry {
    std::string title;  ///< time of the entry
    ReportImage image;
    std::string caption;                                     ///< description; may be empty
    std::vector<std::pair<std::string, std::string>> facts;  ///< names and values
};

struct EditReport {
    std::string model;  ///< file name of the model
    std::string from;
    std::string to;
    std::string summary;  ///< one sentence below `from` and `to`; may be empty
    /// Images of the same views: before[i] and after[i] have the same camera.
    std::vector<ReportImage> before;
    std::vector<ReportImage> after;
    /// Views of the edited region; empty if the whole model is edited.
    std::vector<ReportImage> region;
    std::string region_note;
    std::optional<ReportImage> turntable;
    std::vector<TexturePair> textures;
    std::vector<Score> scores;
    std::vector<TimelineEntry> timeline;  ///< entries in chronological order
    std::string timeline_note;            ///< meaning of the timeline's numbers
    std::vector<Chart> charts;
    TableRows settings;
    std::vector<std::pair<std::string, double>> seconds;  ///< duration of each stage
    std::vector<std::string> warnings;
    /// Labels and paths, such as {"model.glb", "model.glb"}. Paths are relative to the report. The
    /// first file is highlighted.
    std::vector<std::pair<std::string, std::string>> files;
    std::string command;  ///< command line that repeats the edit
    std::string version;
};

std::string edit_report_html(const EditReport& report);

}  // namespace item3d
