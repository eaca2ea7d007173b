#include "item3d/layers/layer_use.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

struct ChannelName {
    const char* name;
    bool LayerChannels::*channel;
};
constexpr ChannelName channel_names[] = {{"base_color", &LayerChannels::base_color},
                                         {"occlusion", &LayerChannels::occlusion},
                                         {"roughness", &LayerChannels::roughness},
                                         {"metallic", &LayerChannels::metallic},
                                         {"normal", &LayerChannels::normal}};

/// Returns the end of the longest text before a colon that is an existing path; if there is none,
/// the end of the text before the first colon.
std::size_t end_of_path(const std::string& text) {
    std::error_code ignored;
    for (std::size_t end = text.size(); end != std::string::npos && end > 0;
         end = text.rfind(':', end - 1)) {
        if (fs::exists(text.substr(0, end), ignored)) return end;
    }
    return std::min(text.find(':'), text.size());
}

std::int64_t parse_strength(const std::string& text, const std::string& subject) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    // The comparisons are false for NaN.
    const bool is_number = !text.empty() && *end == '\0';
    if (!is_number || !(value >= LayerUse::lowest && value <= LayerUse::highest))
        throw UsageError(
            fmt::format("{}: invalid strength '{}', expected a number from {:g} to {:g}", subject,
                        text, LayerUse::lowest, LayerUse::highest));
    return std::llround(value * LayerUse::strength_steps);
}

LayerChannels parse_channels(const std::string& text, const std::string& subject) {
    LayerChannels channels{false, false, false, false, false};
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string name = text.substr(begin, end - begin);
        bool is_known = false;
        for (const ChannelName& known : channel_names) {
            if (name != known.name) continue;
            channels.*known.channel = is_known = true;
        }
        if (!is_known)
            throw UsageError(subject + ": unknown channel '" + name +
                             "'; channels are base_color, occlusion, roughness, metallic, normal");
        begin = end + 1;
    }
    return channels;
}

}  // namespace

LayerUse parse_layer_use(const std::string& text) {
    LayerUse use;
    const std::size_t end = end_of_path(text);
    use.layer = text.substr(0, end);
    std::error_code ignored;
    if (fs::is_directory(use.layer, ignored)) {
        const fs::path file = use.layer / "layer.safetensors";
        if (!fs::exists(file, ignored))
            throw InputError(use.layer.string(), "has no layer.safetensors",
                             "give the folder of one edit (of a plan: its folders 1, 2, ...); "
                             "methods that paint views and edits of the light write no layer");
        use.layer = file;
    }
    if (end >= text.size()) return use;
    const std::size_t second = text.find(':', end + 1);
    use.strength = parse_strength(
        text.substr(end + 1, second == std::string::npos ? second : second - end - 1), text);
    if (second != std::string::npos) use.channels = parse_channels(text.substr(second + 1), text);
    return use;
}

std::string strength_text(const LayerUse& use) {
    std::vector<std::string> names;
    for (const ChannelName& known : channel_names)
        if (use.channels.*known.channel) names.emplace_back(known.name);
    const bool is_whole = names.size() == std::size(channel_names);
    if (is_whole && use.strength == LayerUse::strength_steps) return "";
    std::string text =
        fmt::format("{:g}", static_cast<double>(use.strength) / LayerUse::strength_steps);
    if (!is_whole) text += fmt::format(":{}", fmt::join(names, ","));
    return text;
}

}  // namespace item3d
