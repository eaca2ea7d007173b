#include "item3d/io/obj/parse.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace item3d {
namespace {

/// An error that occurs on several lines; only the first is reported.
struct Flaw {
    int line = 0;
    std::size_t count = 0;
    void add(int at) {
        if (count++ == 0) line = at;
    }
};

/// Index beyond every list, for missing elements.
constexpr std::int32_t no_such_index = std::numeric_limits<std::int32_t>::max();

class ObjParser {
  public:
    ObjParser(std::string_view text, std::string subject)
        : subject_(std::move(subject)), lines_(text) {}

    ObjFile parse() {
        for (std::string_view line; lines_.next(line);)
            read_statement(line);
        check_indices();
        warn_of_flaws();
        return std::move(file_);
    }

  private:
    [[noreturn]] void fail(int line, const std::string& problem,
                           const std::string& hint = "correct the line, or export again") const {
        throw InputError(fmt::format("{}:{}", subject_, line), problem, hint);
    }

    void read_statement(std::string_view line) {
        const std::string_view key = take_word(line);
        const std::string_view rest = line.substr(0, line.find('#'));
        if (key == "v") {
            read_vertex(rest);
        } else if (key == "vt") {
            file_.uvs.emplace_back(read_vector(rest, not_finite_uvs_));
        } else if (key == "vn") {
            const Vec3 value = read_vector(rest, not_finite_normals_);
            const double length = glm::length(glm::dvec3(value));
            file_.normals.push_back(length > 0.0 ? Vec3(glm::dvec3(value) / length) : Vec3(0.0f));
        } else if (key == "f") {
            read_face(rest);
        } else if (key == "s") {
            read_smoothing(rest);
        } else if (key == "g") {
            group_names_.clear();
            for (std::string_view words = rest, word = take_word(words); !word.empty();
                 word = take_word(words))
                group_names_.push_back(to_utf8(word));
            group_ = no_group_yet;
        } else if (key == "o") {
            object_name_ = to_utf8(trim(rest));
            group_ = no_group_yet;
        } else if (key == "usemtl") {
            use_material(trim(line));
        } else if (key == "mtllib") {
            file_.libraries.emplace_back(trim(line));
        }
    }

    void read_vertex(std::string_view rest) {
        std::array<double, 7> values{};
        std::size_t count = 0;
        for (std::string_view word = take_word(rest); !word.empty() && count < 7;
             word = take_word(rest)) {
            const auto value = parse_number(word);
            if (!value) {
                fail(lines_.line_number(),
                     "expected a number, found '" + to_utf8(word.substr(0, 40)) + "'");
            }
            values[count++] = *value;
        }
        if (count < 3) fail(lines_.line_number(), "a vertex needs three coordinates");
        for (int c = 0; c < 3; ++c) {
            if (!std::isfinite(static_cast<float>(values[c]))) {
                fail(lines_.line_number(), "a vertex has a coordinate that is not a finite number",
                     "export the mesh again");
            }
        }
        file_.positions.emplace_back(values[0], values[1], values[2]);
        // A vertex is "x y z w" with a weight for curves, or "x y z r g b (a)" with a colour.
        if (count >= 6) {
            file_.colors.resize(file_.positions.size() - 1, Vec4(1.0f));
            file_.colors.emplace_back(color_channel(values[3]), color_channel(values[4]),
                                      color_channel(values[5]), 1.0f);
        } else if (!file_.colors.empty()) {
            file_.colors.emplace_back(1.0f);
        }
    }

    float color_channel(double value) {
        if (!std::isfinite(value)) {
            not_finite_colors_.add(lines_.line_number());
            return 1.0f;
        }
        return srgb_to_linear(std::clamp(static_cast<float>(value), 0.0f, 1.0f));
    }

    // Reads up to three numbers; missing ones become 0. Returns a zero vector if any of them is not
    // a number, because a partly invalid texture coordinate or normal is useless.
    Vec3 read_vector(std::string_view words, Flaw& flaw) {
        Vec3 value(0.0f);
        for (int c = 0; c < 3; ++c) {
            const std::string_view word = take_word(words);
            if (word.empty()) break;
            const auto number = parse_number(word);
            if (!number || !std::isfinite(static_cast<float>(*number))) {
                flaw.add(lines_.line_number());
                return Vec3(0.0f);
            }
            value[c] = static_cast<float>(*number);
        }
        return value;
    }

    std::optional<std::int32_t> read_index(std::string_view text, std::size_t count) const {
        const auto value = parse_number(text);
        const double limit = std::numeric_limits<std::int32_t>::max() - 1;
        if (!value || *value != std::floor(*value) || std::abs(*value) > limit) {
            fail(lines_.line_number(), "expected an index (from 1, or negative), found '" +
                                           to_utf8(text.substr(0, 40)) + "'");
        }
        const auto index = static_cast<std::int64_t>(*value);
        const std::int64_t from_zero =
            index > 0 ? index - 1 : static_cast<std::int64_t>(count) + index;
        if (index == 0 || from_zero < 0) return std::nullopt;
        return static_cast<std::int32_t>(from_zero);
    }

    ObjCorner read_corner(std::string_view word) const {
        ObjCorner corner;
        const std::size_t first = word.find('/');
        const std::string_view position = word.substr(0, first);
        const auto index = read_index(position, file_.positions.size());
        if (!index) {
            fail(lines_.line_number(), fmt::format("index {} points before the first of {}",
                                                   position, file_.positions.size()));
        }
        corner.position = *index;
        if (first == std::string_view::npos) return corner;
        const std::string_view rest = word.substr(first + 1);
        const std::size_t second = rest.find('/');
        const std::string_view uv = rest.substr(0, second);
        if (!uv.empty()) corner.uv = read_index(uv, file_.uvs.size()).value_or(no_such_index);
        if (second != std::string_view::npos && second + 1 < rest.size()) {
            corner.normal =
                read_index(rest.substr(second + 1), file_.normals.size()).value_or(no_such_index);
        }
        return corner;
    }

    void read_face(std::string_view rest) {
        const std::size_t first = file_.corners.size();
        for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest))
            file_.corners.push_back(read_corner(word));
        const std::size_t count = file_.corners.size() - first;
        if (count < 3) {
            file_.corners.resize(first);
            short_faces_.add(lines_.line_number());
            return;
        }
        if (material_ < 0) use_material("");
        if (group_ == no_group_yet) use_group();
        file_.faces.push_back({first, static_cast<std::uint32_t>(count), material_,
                               lines_.line_number(), smoothing_, group_});
    }

    void use_group() {
        std::vector<std::string> names = group_names_;
        if (!object_name_.empty()) names.push_back(object_name_);
        group_ = -1;
        if (names.empty()) return;
        const auto [entry, is_new] =
            group_indices_.try_emplace(names, static_cast<int>(file_.groups.size()));
        group_ = entry->second;
        if (is_new) file_.groups.push_back(std::move(names));
    }

    void read_smoothing(std::string_view rest) {
        const std::string word = to_lower(take_word(rest));
        const auto number = parse_number(word);
        if (word == "off" || word == "null") {
            smoothing_ = 0;
        } else if (word == "on") {
            smoothing_ = 1;
        } else if (number && *number >= 0.0 && *number < 4294967296.0) {
            smoothing_ = static_cast<std::int64_t>(*number);
        }
    }

    void use_material(std::string_view name) {
        const auto [entry, is_new] = material_indices_.try_emplace(
            std::string(name), static_cast<int>(file_.material_names.size()));
        material_ = entry->second;
        if (is_new) file_.material_names.emplace_back(name);
    }

    // Checks the indices of faces. Must run at the end, because lists may continue after the faces
    // that use them.
    void check_indices() {
        for (const ObjFace& face : file_.faces) {
            for (std::uint32_t i = 0; i < face.corner_count; ++i) {
                ObjCorner& corner = file_.corners[face.first_corner + i];
                if (static_cast<std::size_t>(corner.position) >= file_.positions.size()) {
                    fail(face.line,
                         fmt::format("a face uses vertex {} of {}", corner.position + 1,
                                     file_.positions.size()),
                         "the file is damaged or cut short; export it again");
                }
                const auto leave_out = [&](std::int32_t& index, std::size_t count, Flaw& flaw) {
                    if (index < 0 || static_cast<std::size_t>(index) < count) return;
                    index = -1;
                    flaw.add(face.line);
                };
                leave_out(corner.uv, file_.uvs.size(), missing_uvs_);
                leave_out(corner.normal, file_.normals.size(), missing_normals_);
            }
        }
    }

    void warn_of_flaws() const {
        const auto say = [&](const Flaw& flaw, const std::string& what) {
            if (flaw.count == 0) return;
            warn(fmt::format(
                "{}:{}: {}{}", subject_, flaw.line, what,
                flaw.count > 1 ? fmt::format(" (the first of {})", flaw.count) : std::string()));
        };
        say(short_faces_, "a face with less than three corners is left out");
        say(not_finite_uvs_, "a texture coordinate is not a finite number; 0 is used");
        say(not_finite_normals_,
            "a normal is not a finite number; a normal computed from the faces is used");
        say(not_finite_colors_, "a vertex colour is not a finite number; white is used");
        say(missing_uvs_,
            file_.uvs.empty()
                ? "a corner refers to a texture coordinate, but the file has none; it is ignored"
                : fmt::format(
                      "a corner has a texture coordinate index outside the file's {}; 0 is used",
                      file_.uvs.size()));
        say(missing_normals_,
            fmt::format(
                "a corner refers to a normal, but {}; a normal computed from the faces is used",
                file_.normals.empty()
                    ? "the file has none"
                    : fmt::format("its index is outside the file's {}", file_.normals.size())));
    }

    std::string subject_;
    LineReader lines_;
    ObjFile file_;
    std::map<std::string, int> material_indices_;
    std::map<std::vector<std::string>, int> group_indices_;
    std::vector<std::string> group_names_;
    std::string object_name_;
    static constexpr int no_group_yet = -2;
    int group_ = -1;
    int material_ = -1;
    std::int64_t smoothing_ = unsaid_smoothing;
    Flaw short_faces_, not_finite_uvs_, not_finite_normals_, not_finite_colors_, missing_uvs_,
        missing_normals_;
};

}  // namespace

ObjFile parse_obj(std::string_view text, const std::string& subject) {
    return ObjParser(text, subject).parse();
}

}  // namespace item3d
