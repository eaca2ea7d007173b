#include "item3d/guidance/guidance.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/guidance/rdl.h"
#include "item3d/guidance/sds.h"

#include <algorithm>

namespace item3d {
namespace {

void require_one_of(const std::string& option, const std::string& value,
                    const std::vector<std::string>& names) {
    if (std::find(names.begin(), names.end(), value) == names.end()) {
        throw InputError(option, fmt::format("'{}' is not known", value),
                         fmt::format("choose one of {}", fmt::join(names, ", ")));
    }
}

bool is_blank(const std::string& text) {
    return std::all_of(text.begin(), text.end(),
                       [](unsigned char c) { return std::isspace(c) != 0; });
}

}  // namespace

const std::vector<std::string>& guidance_methods() {
    static const std::vector<std::string> names = {"rdl", "sds"};
    return names;
}

const std::vector<std::string>& adjustment_names() {
    static const std::vector<std::string> names = {"learned", "off"};
    return names;
}

Weighting parse_weighting(const std::string& name) {
    static const std::vector<std::string> names = {"early", "late", "dreamfusion", "uniform"};
    require_one_of("--weighting", name, names);
    return static_cast<Weighting>(std::find(names.begin(), names.end(), name) - names.begin());
}

std::unique_ptr<Guidance> make_guidance(std::shared_ptr<const Pipeline> pipeline,
                                        const std::string& source_prompt,
                                        const std::string& target_prompt,
                                        const GuidanceOptions& options) {
    require_one_of("--guidance", options.method, guidance_methods());
    require_one_of("--adjust", options.adjust, adjustment_names());
    if (is_blank(source_prompt)) {
        throw InputError("--from", "the prompt is empty", "describe the model as it looks now");
    }
    if (is_blank(target_prompt)) {
        throw InputError("--to", "the prompt is empty", "describe the look that you want");
    }
    if (options.method == "sds") {
        return std::make_unique<ScoreDistillation>(std::move(pipeline), target_prompt, options);
    }
    return std::make_unique<RelativeDirection>(std::move(pipeline), source_prompt, target_prompt,
                                               options);
}

}  // namespace item3d
