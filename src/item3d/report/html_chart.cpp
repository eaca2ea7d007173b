#include "item3d/report/html_chart.h"

#include "item3d/core/format.h"
#include "item3d/report/html.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace item3d {

namespace {

// Units of the drawing, which the page scales.
constexpr double width = 480;
constexpr double height = 210;
constexpr double left_margin = 46;
constexpr double right_margin = 8;
constexpr double top_margin = 8;
constexpr double bottom_margin = 34;
constexpr int palette = 6;

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void include(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    bool empty() const { return !(low <= high); }
    void widen_if_flat() {
        if (high > low) return;
        const double pad = low == 0 ? 1 : std::abs(low) * 0.1;
        low -= pad;
        high += pad;
    }
};

/// Returns a step for about `count` steps over the range: 1, 2 or 5 times a power of ten.
double nice_step(const Range& range, int count) {
    const double rough = (range.high - range.low) / count;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor * power >= rough) return factor * power;
    }
    return 10 * power;
}

std::string tick_label(double value, double step) {
    if (std::abs(value) < step * 1e-6) return "0";
    const double size = std::max(std::abs(value), step);
    if (size >= 1e6 || size < 1e-4) return fmt::format("{:.2g}", value);
    const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
    return fmt::format("{:.{}f}", value, decimals);
}

/// Returns an exponential running mean over about a thirtieth of the curve. It starts at the first
/// value.
std::vector<double> running_mean(const std::vector<double>& values) {
    const double keep = std::exp(-1 / std::max(2.0, static_cast<double>(values.size()) / 30));
    std::vector<double> result;
    double mean = std::numeric_limits<double>::quiet_NaN();
    for (const double value : values) {
        if (std::isfinite(value))
            mean = std::isnan(mean) ? value : keep * mean + (1 - keep) * value;
        result.push_back(std::isfinite(value) ? mean : value);
    }
    return result;
}

class Axes {
  public:
    Axes(Range x, Range y) : x_(x), y_(y) {}
    double across(double x) const {
        return left_margin +
               (x - x_.low) / (x_.high - x_.low) * (width - left_margin - right_margin);
    }
    double down(double y) const {
        return top_margin +
               (y_.high - y) / (y_.high - y_.low) * (height - top_margin - bottom_margin);
    }

    std::string frame(const std::string& x_label) const {
        std::string svg;
        const double step_y = nice_step(y_, 4);
        for (double y = std::ceil(y_.low / step_y - 1e-9) * step_y; y <= y_.high + 1e-9 * step_y;
             y += step_y) {
            svg += fmt::format(
                "<line class=\"axis\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>"
                "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                left_margin, width - right_margin, down(y), down(y), left_margin - 7, down(y) + 4,
                tick_label(y, step_y));
        }
        const double step_x = nice_step(x_, 5);
        for (double x = std::ceil(x_.low / step_x - 1e-9) * step_x; x <= x_.high + 1e-9 * step_x;
             x += step_x) {
            svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                               across(x), height - bottom_margin + 16, tick_label(x, step_x));
        }
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                           width - right_margin, height - 4, html_escape(x_label));
        return svg;
    }

    /// Returns the curve's path. It is thinned to fewer than 1200 points, which are more than a
    /// screen shows.
    std::string path(const Curve& curve, const std::vector<double>& values,
                     const std::string& attributes) const {
        std::string data;
        bool pen_down = false;
        const std::size_t stride = std::max<std::size_t>(1, values.size() / 600);
        for (std::size_t i = 0; i < values.size(); i += stride) {
            if (!std::isfinite(values[i])) {
                pen_down = false;
                continue;
            }
            const double x = curve.first + curve.step * static_cast<double>(i);
            const double clamped = std::clamp(values[i], y_.low, y_.high);
            data += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", across(x), down(clamped));
            pen_down = true;
        }
        return fmt::format("<path {} d=\"{}\"/>\n", attributes, data);
    }

  private:
    Range x_;
    Range y_;
};

}  // namespace

std::string html_chart(const Chart& chart) {
    Range x;
    Range y;
    std::string legend;
    for (std::size_t k = 0; k < chart.curves.size(); ++k) {
        const Curve& curve = chart.curves[k];
        for (std::size_t i = 0; i < curve.values.size(); ++i) {
            if (!std::isfinite(curve.values[i])) continue;
            x.include(curve.first + curve.step * static_cast<double>(i));
            y.include(curve.values[i]);
        }
        legend += fmt::format("<li style=\"--c:var(--c{})\">{}</li>", k % palette,
                              html_escape(curve.name));
    }
    const std::string head = fmt::format("<div class=\"chart\"><h3>{}</h3><ul>{}</ul>\n",
                                         html_escape(chart.title), legend);
    if (x.empty()) return head + "<p>No values were recorded.</p></div>\n";
    x.widen_if_flat();
    y.widen_if_flat();
    // A scale that nearly reaches zero begins there, so that heights can be compared.
    if (y.low > 0 && y.low < 0.6 * y.high) y.low = 0;

    const Axes axes(x, y);
    std::string svg = axes.frame(chart.x_label);
    for (std::size_t k = 0; k < chart.curves.size(); ++k) {
        const Curve& curve = chart.curves[k];
        const std::string color = fmt::format("style=\"--c:var(--c{})\"", k % palette);
        if (chart.smooth) svg += axes.path(curve, curve.values, "class=\"raw\" " + color);
        svg += axes.path(curve, chart.smooth ? running_mean(curve.values) : curve.values, color);
    }
    return head +
           fmt::format(
               "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n{}</svg></div>\n",
               width, height, html_escape(chart.title), svg);
}

}  // namespace item3d
