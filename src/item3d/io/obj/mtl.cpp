#include "item3d/io/obj/mtl.h"

#include "item3d/core/files.h"
#include "item3d/io/text.h"

#include <cmath>

namespace item3d {
namespace {

std::optional<float> read_number(std::string_view text) {
    const auto value = parse_number(take_word(text));
    if (!value || !std::isfinite(static_cast<float>(*value))) return std::nullopt;
    return static_cast<float>(*value);
}

// "Kd 0.5" is grey; "Kd spectral ..." and "Kd xyz ..." are not numbers and are left out.
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

// How many words may follow an option; numeric ones may be fewer than that.
struct OptionShape {
    std::string_view name;
    int most_words;
    bool numeric;
};
constexpr OptionShape option_shapes[] = {
    {"-s", 3, true},       {"-o", 3, true},           {"-t", 3, true},      {"-mm", 2, true},
    {"-bm", 1, true},      {"-boost", 1, true},       {"-texres", 1, true}, {"-clamp", 1, false},
    {"-blendu", 1, false}, {"-blendv", 1, false},     {"-cc", 1, false},    {"-imfchan", 1, false},
    {"-type", 1, false},   {"-colorspace", 1, false},
};

// Everything after the options is the name: it may hold blanks.
std::optional<MtlMap> read_map(std::string_view text) {
    MtlMap map;
    text = trim(text);
    while (text.starts_with('-')) {
        std::string_view rest = text;
        const std::string option = to_lower(take_word(rest));
        const OptionShape* shape = nullptr;
        for (const OptionShape& candidate : option_shapes) {
            if (candidate.name == option) shape = &candidate;
        }
        if (!shape) break;
        float values[3] = {0, 0, 0};
        std::string word;
        int count = 0;
        for (; count < shape->most_words; ++count) {
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
        if (option == "-s" && count > 0)
            map.scale = Vec2(values[0], count > 1 ? values[1] : values[0]);
        if (option == "-o" && count > 0) map.offset = Vec2(values[0], count > 1 ? values[1] : 0.0f);
        if (option == "-bm" && count > 0) map.bump_multiplier = values[0];
        if (option == "-clamp") map.clamp = word == "on";
        text = trim(rest);
    }
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
        text = text.substr(1, text.size() - 2);
    }
    if (text.empty()) return std::nullopt;
    map.file = std::string(text);
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
        material.opacity = read_number(rest);
    } else if (key == "tr") {
        if (const auto value = read_number(rest)) material.opacity = 1.0f - *value;
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

}  // namespace

std::map<std::string, MtlMaterial> read_mtl(const std::filesystem::path& path) {
    const std::string text = read_text(path);
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
    return materials;
}

}  // namespace item3d
