#include "item3d/io/obj/mtl.h"

#include "item3d/core/files.h"
#include "item3d/io/encoding.h"
#include "item3d/io/text.h"

#include <cmath>

namespace item3d {
namespace {

std::optional<float> read_number(std::string_view text) {
    const auto value = parse_number(take_word(text));
    if (!value || !std::isfinite(static_cast<float>(*value))) return std::nullopt;
    return static_cast<float>(*value);
}

// Reads a colour. "Kd 0.5" is grey; "Kd spectral ..." and "Kd xyz ..." are not numbers and are
// ignored.
std::optional<Vec3> read_color(std::string_view text) {
    Vec3 color(0.0f);
    for (int c = 0; c < 3; ++c) {
        const auto value = parse_number(take_word(text));
        if (!value && c == 1) return Vec3(color.x);
        if (!value || !std::isfinite(static_cast<float>(*value))) return std::nullopt;
        color[c] = static_cast<float>(*value);
    }
    return color;
}

// An option and the largest number of words after it. Options with numbers may have fewer words.
struct OptionShape {
    std::string_view name;
    int max_words;
    bool numeric;
};
constexpr OptionShape option_shapes[] = {
    {"-s", 3, true},       {"-o", 3, true},           {"-t", 3, true},      {"-mm", 2, true},
    {"-bm", 1, true},      {"-boost", 1, true},       {"-texres", 1, true}, {"-clamp", 1, false},
    {"-blendu", 1, false}, {"-blendv", 1, false},     {"-cc", 1, false},    {"-imfchan", 1, false},
    {"-type", 1, false},   {"-colorspace", 1, false},
};

const OptionShape* option_shape(std::string_view word) {
    const std::string option = to_lower(word);
    for (const OptionShape& candidate : option_shapes) {
        if (candidate.name == option) return &candidate;
    }
    return nullptr;
}

// Removes an option and its words from the start of the text; returns false, and changes nothing,
// if there is none.
bool take_option(std::string_view& text, MtlMap& map) {
    std::string_view rest = text;
    const OptionShape* shape = option_shape(take_word(rest));
    if (!shape) return false;
    float values[3] = {0, 0, 0};
    std::string word;
    int count = 0;
    for (; count < shape->max_words; ++count) {
        std::string_view ahead = rest;
        const std::string_view next = take_word(ahead);
        if (shape->numeric) {
            const auto value = parse_number(next);
            if (!value || !std::isfinite(*value)) break;
            values[count] = static_cast<float>(*value);
        } else {
            word = to_lower(next);
        }
        rest = ahead;
    }
    if (shape->name == "-s" && count > 0)
        map.scale = Vec2(values[0], count > 1 ? values[1] : values[0]);
    if (shape->name == "-o" && count > 0)
        map.offset = Vec2(values[0], count > 1 ? values[1] : 0.0f);
    if (shape->name == "-bm" && count > 0) map.bump_multiplier = values[0];
    if (shape->name == "-clamp") map.clamp = word == "on";
    if (shape->name == "-imfchan") map.channel = word.empty() ? '\0' : word[0];
    text = trim(rest);
    return true;
}

// Removes options that some programs write after the name.
std::string_view without_trailing_options(std::string_view name, MtlMap& map) {
    for (std::size_t at = name.find(" -"); at != std::string_view::npos;
         at = name.find(" -", at + 1)) {
        std::string_view rest = name.substr(at + 1);
        MtlMap with = map;
        while (take_option(rest, with)) {
        }
        if (!rest.empty()) continue;
        map = with;
        return trim(name.substr(0, at));
    }
    return name;
}

std::string_view without_quotes(std::string_view text) {
    const bool is_quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    return is_quoted ? text.substr(1, text.size() - 2) : text;
}

// Reads a map. The whole text after the options is the name, which may contain blanks.
std::optional<MtlMap> read_map(std::string_view text) {
    MtlMap map;
    text = trim(text);
    while (take_option(text, map)) {
    }
    const std::string_view whole = text;
    text = without_quotes(without_trailing_options(without_remark(text), map));
    if (text.empty() && whole.empty()) return std::nullopt;
    map.file = std::string(text);
    if (without_remark(whole) != whole) map.file_and_comment = std::string(without_quotes(whole));
    return map;
}

void read_statement(const std::string& key, std::string_view rest, MtlMaterial& material) {
    if (key == "kd") {
        material.diffuse = read_color(rest);
    } else if (key == "ks") {
        material.specular = read_color(rest);
    } else if (key == "ke") {
        material.emission = read_color(rest);
    } else if (key == "pm") {
        material.metallic = read_number(rest);
    } else if (key == "pr") {
        material.roughness = read_number(rest);
    } else if (key == "ns") {
        material.specular_exponent = read_number(rest);
    } else if (key == "d") {
        std::string_view number = rest;
        if (to_lower(take_word(number)) != "-halo") number = rest;
        material.opacity = read_number(number);
    } else if (key == "tr") {
        material.transparency = read_number(rest);
    } else if (key == "bsdf") {
        material.is_nvdiffrec = to_lower(trim(rest)) == "pbr";
    } else if (key == "map_kd") {
        material.diffuse_map = read_map(rest);
    } else if (key == "map_ks") {
        material.specular_map = read_map(rest);
    } else if (key == "map_ke") {
        material.emission_map = read_map(rest);
    } else if (key == "map_pm") {
        material.metallic_map = read_map(rest);
    } else if (key == "map_pr") {
        material.roughness_map = read_map(rest);
    } else if (key == "map_ao") {
        material.occlusion_map = read_map(rest);
    } else if (key == "map_d") {
        material.opacity_map = read_map(rest);
    } else if (key == "norm" || key == "map_kn") {
        material.normal_map = read_map(rest);
    } else if (key == "map_bump" || key == "bump") {
        material.bump_map = read_map(rest);
    }
}

void set_folder(MtlMaterial& material, const std::filesystem::path& folder) {
    for (auto* map : {&material.diffuse_map, &material.metallic_map, &material.roughness_map,
                      &material.specular_map, &material.occlusion_map, &material.emission_map,
                      &material.normal_map, &material.bump_map, &material.opacity_map}) {
        if (*map) (*map)->folder = folder;
    }
}

}  // namespace

std::string_view without_remark(std::string_view text) {
    text = trim(text);
    for (std::size_t at = text.find('#'); at != std::string_view::npos;
         at = text.find('#', at + 1)) {
        if (at == 0 || text[at - 1] == ' ' || text[at - 1] == '\t') return trim(text.substr(0, at));
    }
    return text;
}

std::map<std::string, MtlMaterial> read_mtl(const std::filesystem::path& path,
                                            std::vector<std::string> names) {
    const std::filesystem::path folder = path.parent_path();
    const std::string bytes = read_text(path);
    if (!is_utf8(bytes)) {
        for (std::string& name : names_below(folder))
            names.push_back(std::move(name));
    }
    const std::string text = decode_text(bytes, names, path.string());
    std::map<std::string, MtlMaterial> materials;
    MtlMaterial* current = nullptr;
    LineReader lines(text);
    for (std::string_view line; lines.next(line);) {
        const std::string key = to_lower(take_word(line));
        if (key == "newmtl") {
            const std::string name(trim(line));
            current = &(materials[name] = MtlMaterial{});
            current->name = name;
        } else if (current && !key.empty() && key.front() != '#') {
            read_statement(key, line, *current);
        }
    }
    for (auto& [name, material] : materials)
        set_folder(material, folder);
    return materials;
}

}  // namespace item3d
