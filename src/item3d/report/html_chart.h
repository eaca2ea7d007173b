// Line charts of self-contained HTML pages.
#pragma once

#include <string>
#include <vector>

namespace item3d {

/// Line of a chart: values[i] is at x = first + i * step. Values that are not finite leave a gap.
struct Curve {
    std::string name;
    std::vector<double> values;
    double first = 0;
    double step = 1;
};

struct Chart {
    std::string title;
    std::string x_label;
    std::vector<Curve> curves;
    /// Draws a running mean over the faint raw line, for noisy curves.
    bool smooth = false;
};

/// Returns a line chart as inline SVG. If there is no finite value, the chart says so.
std::string html_chart(const Chart& chart);

}  // namespace item3d
