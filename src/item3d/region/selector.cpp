#include "item3d/region/selector.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/io/text.h"
#include "item3d/region/auto_selector.h"
#include "item3d/region/color_selector.h"
#include "item3d/region/image_selectors.h"
#include "item3d/region/part_selectors.h"
#include "item3d/region/space_selectors.h"
#include "item3d/region/words_selector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace item3d {
namespace {

struct Kind {
    SelectorKind shown;
    std::function<std::unique_ptr<Selector>(const SelectorText&, const RegionScene&)> make;
};

const std::vector<Kind>& kinds() {
    static const std::vector<Kind> all = {
        {{"material=NAME", "parts with this material"}, select_material},
        {{"node=NAME", "a glTF node and its children"}, select_node},
        {{"mesh=NAME", "a glTF mesh"}, select_mesh},
        {{"group=NAME", "an OBJ group or object (g, o)"}, select_group},
        {{"attribute=_NAME", "a glTF vertex attribute, as written by exporters for vertex groups"},
         select_attribute},
        {{"box=X0,Y0,Z0,X1,Y1,Z1", "a box between two corners, in the model's units"}, select_box},
        {{"sphere=X,Y,Z,R", "a sphere around a point, in the model's units"}, select_sphere},
        {{"mask=FILE[@MATERIAL]", "where an image in UV space is white"}, select_mask},
        {{"view=FILE[@CAMERA]",
          "the surface that is visible where an image of the model is white; CAMERA: "
          "AZIMUTH,ELEVATION in degrees, or a transforms.json, with #FRAME for any but the first "
          "frame; default: the view of item3d render"},
         select_view},
        {{"color=COLOR[~DISTANCE]",
          "where the model's own base colour is within this CIELAB distance (default 12)"},
         select_color},
        {{"named=COLOR",
          "where people would use this name for the base colour: black, white, gray, red, green, "
          "blue, yellow, orange, purple, pink or brown"},
         select_named},
        {{"words=TEXT", "the part that the segmenter recognizes by these words (\"the handle\")"},
         select_words},
        {{"auto", "where the prior sees a difference between the sentences of --from and --to"},
         select_auto},
    };
    return all;
}

}  // namespace

std::unique_ptr<Selector> make_selector(const std::string& text, const RegionScene& scene) {
    const std::size_t equals = text.find('=');
    const std::string kind = text.substr(0, equals);
    for (const Kind& candidate : kinds()) {
        const std::string& form = candidate.shown.form;
        if (kind != form.substr(0, form.find('='))) continue;
        const SelectorText parts{
            text, equals == std::string::npos ? std::string() : text.substr(equals + 1), form};
        const bool takes_value = form.find('=') != std::string::npos;
        if (!takes_value && equals != std::string::npos)
            throw InputError(text, "takes no value", "as in " + form);
        if (takes_value && parts.value.empty())
            throw InputError(text, "a value is missing", "as in " + form);
        return candidate.make(parts, scene);
    }
    std::vector<std::string> forms;
    for (const SelectorKind& known : selector_kinds())
        forms.push_back(known.form);
    throw InputError(text.empty() ? "region" : text, "is not a selector",
                     fmt::format("choose from {}", fmt::join(forms, ", ")));
}

bool is_independent_of_textures(const std::string& text) {
    const std::string kind = text.substr(0, text.find('='));
    constexpr std::array independent = {"material", "node",   "mesh", "group", "attribute",
                                        "box",      "sphere", "mask", "view"};
    return std::find(independent.begin(), independent.end(), kind) != independent.end();
}

const std::vector<SelectorKind>& selector_kinds() {
    static const std::vector<SelectorKind> shown = [] {
        std::vector<SelectorKind> all;
        for (const Kind& kind : kinds())
            all.push_back(kind.shown);
        return all;
    }();
    return shown;
}

std::vector<float> numbers_of(const SelectorText& text, std::size_t count) {
    std::vector<float> numbers;
    std::size_t begin = 0;
    while (begin <= text.value.size()) {
        const std::size_t end = std::min(text.value.find(',', begin), text.value.size());
        const auto number = parse_number(trim(text.value.substr(begin, end - begin)));
        if (!number || !std::isfinite(*number)) break;
        numbers.push_back(static_cast<float>(*number));
        begin = end + 1;
    }
    if (begin <= text.value.size() || numbers.size() != count)
        throw InputError(text.whole, fmt::format("expected {} numbers", count),
                         "as in " + text.form);
    return numbers;
}

}  // namespace item3d
