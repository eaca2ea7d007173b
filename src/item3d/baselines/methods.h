// The list of an edit's methods: this project's own, and published ones for comparison.
#pragma once

#include "item3d/baselines/view_painter.h"

#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// A value of the option --method.
struct EditMethod {
    std::string name;
    std::string description;
    std::string cost;  ///< number of U-Net evaluations, in words
};
const std::vector<EditMethod>& edit_methods();
const std::vector<std::string>& edit_method_names();

/// Returns a method's published or required settings, by EditSettings' names; empty for "item3d".
nlohmann::json method_settings(const std::string& method);

/// True if a method paints texels view after view (ViewPainter), instead of optimising a neural
/// texture.
bool paints_views(const std::string& method);
/// Returns the number of steps of a method that paints views.
std::int64_t painter_steps(const std::string& method, const PainterOptions& options);
std::unique_ptr<ViewPainter> make_painter(const std::string& method, const PaintingScene& scene,
                                          const PainterOptions& options);

}  // namespace item3d
