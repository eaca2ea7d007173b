#include "item3d/prior/data/part_labels.h"

#include "item3d/core/error.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/materials/colors.h"
#include "item3d/prior/data/shapes/shapes.h"

#include <algorithm>
#include <set>

namespace item3d {
namespace {

const std::string& one_of(Random& random, const std::vector<std::string>& from) {
    return from[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(from.size())))];
}

bool listed(const std::vector<std::string>& list, const std::string& text) {
    return std::find(list.begin(), list.end(), text) != list.end();
}

/// Returns "wooden" for "wooden {o}". Phrases of other forms are left out; repeated phrases are
/// kept.
std::vector<std::string> adjectives(const std::vector<std::string>& phrases) {
    std::vector<std::string> result;
    for (const std::string& phrase : adjective_phrases(phrases))
        result.push_back(phrase.substr(0, phrase.size() - 4));
    return result;
}

/// Returns "wheel" for "wheels" or the reverse, with a small probability.
std::string either_number(Random& random, const std::string& noun) {
    if (!random.chance(.15)) return noun;
    return noun.ends_with("s") ? noun.substr(0, noun.size() - 1) : noun + "s";
}

/// Returns "wheel" for "wheels".
std::string one_of_them(const std::string& noun) {
    return noun.ends_with("s") ? noun.substr(0, noun.size() - 1) : noun;
}

/// Returns "red handle", "the red handle", or "a red handle of a mug".
std::string asked(Random& random, const std::string& thing, const std::string& object = "") {
    const double form = random.uniform();
    if (form < .4) return thing;
    if (form < .7) return "the " + thing;
    if (form < .85 || object.empty()) return mend_articles("a " + thing);
    return mend_articles("the " + thing + " of a " + object);
}

/// Returns the material's plainest name if it is a colour. Otherwise returns null, because wood,
/// for example, may also be called brown.
const std::string* color_of(const std::vector<std::string>& phrases) {
    if (phrases.empty()) return nullptr;
    for (const PlainColor& color : plain_colors())
        if (phrases.front() == color.name || phrases.front().ends_with(" " + color.name))
            return &color.name;
    return nullptr;
}

std::vector<std::string> all_object_nouns() {
    std::vector<std::string> nouns;
    for (const ShapeClass& shape : shape_classes())
        if (!shape.held_out)
            for (const std::string& noun : shape.nouns)
                if (noun != "object") nouns.push_back(noun);
    return nouns;
}

/// Draws a prompt about something absent. Returns an empty text if nothing absent was found.
PartPrompt absent_prompt(Random& random, const PartLabels& labels) {
    const double kind = random.uniform();
    if (kind < .55) {
        const std::string& noun = one_of(random, all_part_nouns());
        if (!has_named(labels, noun)) return {asked(random, either_number(random, noun)), 0};
    } else if (kind < .8) {
        static const std::vector<std::string> nouns = all_object_nouns();
        const std::string& noun = one_of(random, nouns);
        // The labels of a held-out object say only "object", which excludes no noun.
        if (!has_named(labels, noun) && !has_named(labels, "object"))
            return {asked(random, noun), 0};
    } else {
        const std::string* rest = color_of(labels.phrases);
        const std::string* own = labels.own ? color_of(labels.own_phrases) : rest;
        if (!rest || !own) return {};
        const auto& colors = plain_colors();
        const PlainColor& color = colors[static_cast<std::size_t>(
            random.index(static_cast<std::int64_t>(colors.size())))];
        const auto clashes = [&](const std::string& there) {
            return there == color.name || colors_alike(there, color.name);
        };
        if (!clashes(*rest) && !clashes(*own))
            return {asked(random, color.name + (random.chance(.7) ? " part" : "")), 0};
    }
    return {};
}

/// Draws a prompt about the material of the object, or of the part that has a material of its own.
PartPrompt material_prompt(Random& random, const PartLabels& labels) {
    if (labels.phrases.empty() || (labels.own && labels.own_phrases.empty())) return {};
    const std::uint32_t whole = whole_object(labels);
    if (!labels.own) {
        const std::string& word = one_of(random, labels.phrases);
        return {asked(random, word + " " + (random.chance(.5) ? labels.nouns[0] : "part")), whole};
    }
    const bool of_part = random.chance(.6);
    const std::string& word = one_of(random, of_part ? labels.own_phrases : labels.phrases);
    const std::uint32_t parts = of_part ? labels.own : whole & ~labels.own;
    if (random.chance(.25)) return {word, parts};
    return {asked(random, word + " part", labels.nouns[0]), parts};
}

PartPrompt named_prompt(Random& random, const PartLabels& labels,
                        const std::vector<std::string>& names) {
    const std::string& noun = one_of(random, names);
    const std::uint32_t parts = parts_named(labels, noun);
    std::string thing = either_number(random, noun);
    const auto& phrases = labels.own == parts ? labels.own_phrases : labels.phrases;
    const bool of_one_material = labels.own == parts || (labels.own & parts) == 0;
    if (!phrases.empty() && of_one_material && random.chance(labels.own ? .3 : .1))
        thing = one_of(random, phrases) + " " + thing;
    return {asked(random, thing, labels.nouns[0]), parts};
}

}  // namespace

void to_json(nlohmann::json& json, const PartLabels& labels) {
    json = nlohmann::json::array({labels.shape_class, labels.nouns, labels.parts, labels.seen,
                                  labels.own, labels.phrases, labels.own_phrases});
}

void from_json(const nlohmann::json& json, PartLabels& labels) {
    json.at(0).get_to(labels.shape_class);
    json.at(1).get_to(labels.nouns);
    json.at(2).get_to(labels.parts);
    json.at(3).get_to(labels.seen);
    json.at(4).get_to(labels.own);
    json.at(5).get_to(labels.phrases);
    json.at(6).get_to(labels.own_phrases);
}

PartLabels part_labels_of(const Example& example) {
    const ShapeView& view = *example.view;
    const ShapeClass& shape = shape_classes()[static_cast<std::size_t>(view.shape_class)];
    ITEM3D_CHECK(view.parts.size() <= max_parts, "a shape has too many parts");
    PartLabels labels;
    labels.shape_class = shape.name;
    labels.nouns = shape.held_out ? std::vector<std::string>{"object"} : shape.nouns;
    labels.parts = view.parts;
    std::vector<std::size_t> counts(view.parts.size(), 0);
    for (const std::uint8_t part : view.part)
        ++counts[part];
    for (const std::size_t count : counts)
        labels.seen.push_back(count == 0 ? 0 : count * 80 < view.count() ? 1 : 2);
    if (example.own_part > 0) labels.own = 1u << example.own_part;
    labels.phrases = adjectives(example.phrases);
    labels.own_phrases = adjectives(example.part_phrases);
    return labels;
}

at::Tensor part_map_of(const Example& example) {
    const ShapeView& view = *example.view;
    const int size = view.size / view_samples;
    at::Tensor map = at::zeros({size, size}, at::kByte);
    auto* out = map.mutable_data_ptr<std::uint8_t>();
    for (std::size_t i = 0; i < view.count(); ++i) {
        const int y = view.pixel[i] / view.size, x = view.pixel[i] % view.size;
        // One sample per pixel suffices.
        if (y % view_samples != 0 || x % view_samples != 0) continue;
        const int column = x / view_samples;
        out[y / view_samples * size + (example.mirrored ? size - 1 - column : column)] =
            static_cast<std::uint8_t>(view.part[i] + 1);
    }
    return map;
}

std::uint32_t parts_named(const PartLabels& labels, const std::string& noun) {
    std::uint32_t parts = 0;
    for (std::size_t i = 0; i < labels.parts.size(); ++i)
        if (labels.parts[i] == noun) parts |= 1u << i;
    return parts;
}

std::uint32_t whole_object(const PartLabels& labels) {
    const std::size_t count = labels.parts.size();
    return count >= max_parts ? ~0u : (1u << count) - 1;
}

std::vector<std::string> named_parts(const PartLabels& labels) {
    std::vector<std::string> names;
    for (std::size_t i = 1; i < labels.parts.size(); ++i)
        if (labels.seen[i] == 2 && !labels.parts[i].empty() && !listed(names, labels.parts[i]))
            names.push_back(labels.parts[i]);
    return names;
}

bool has_named(const PartLabels& labels, const std::string& noun) {
    const auto is = [&](const std::string& name) { return one_of_them(name) == one_of_them(noun); };
    return std::any_of(labels.parts.begin(), labels.parts.end(), is) ||
           std::any_of(labels.nouns.begin(), labels.nouns.end(), is);
}

const std::vector<std::string>& all_part_nouns() {
    static const std::vector<std::string> nouns = [] {
        std::set<std::string> all;
        for (const ShapeClass& shape : shape_classes())
            all.insert(part_nouns(shape.name).begin(), part_nouns(shape.name).end());
        return std::vector<std::string>(all.begin(), all.end());
    }();
    return nouns;
}

PartPrompt draw_part_prompt(Random& random, const PartLabels& labels) {
    const std::vector<std::string> names = named_parts(labels);
    PartPrompt prompt;
    const double kind = random.uniform();
    if (kind < .45 && !names.empty())
        prompt = named_prompt(random, labels, names);
    else if (kind < .68)
        prompt = material_prompt(random, labels);
    else if (kind < .88)
        prompt = absent_prompt(random, labels);
    if (!prompt.text.empty()) return prompt;
    const bool unnamed = random.chance(.2);
    return {asked(random, unnamed ? "object" : one_of(random, labels.nouns)), whole_object(labels)};
}

}  // namespace item3d
