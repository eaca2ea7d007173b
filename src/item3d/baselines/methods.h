// The methods of an edit: this project's own, and the published ones that it is compared with.
#pragma once

#include "item3d/baselines/view_painter.h"

#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// A method that --method takes.
struct EditMethod {
    std::string name;
    std::string description;
    std::string cost;  ///< rows of the U-Net
};
const std::vector<EditMethod>& edit_methods();
const std::vector<std::string>& edit_method_names();

/// Settings that a method was published with, or must have, by EditSettings' names; empty for
/// "item3d".
nlohmann::json method_settings(const std::string& method);

/// Whether a method paints texels view after view (ViewPainter), instead of moving a neural texture
/// step by step.
bool paints_views(const std::string& method);
/// Steps of such a method.
std::int64_t painter_steps(const std::string& method, const PainterOptions& options);
std::unique_ptr<ViewPainter> make_painter(const std::string& method, const PaintingScene& scene,
                                          const PainterOptions& options);

}  // namespace item3d
