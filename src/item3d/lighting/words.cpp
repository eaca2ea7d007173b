#include "item3d/lighting/words.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

namespace item3d {

namespace {

// Elevations in degrees above the horizon.
constexpr float usual_elevation = 25;
constexpr float camera_elevation = 18;  // a lamp on the camera, which is slightly above the model
constexpr float low_elevation = 8;
constexpr float high_elevation = 60;
constexpr float above_elevation = 45;  // for "from above left"; "from above" alone is the zenith
constexpr float below_elevation = -35;

struct Word {
    std::string text;
    std::size_t begin;  ///< position in the sentence
    std::size_t end;
};

std::vector<Word> words_of(const std::string& sentence) {
    std::vector<Word> words;
    std::size_t i = 0;
    const auto kind = [&](std::size_t at) {
        const auto byte = static_cast<unsigned char>(sentence[at]);
        return std::isdigit(byte) ? 1 : std::isalpha(byte) || byte >= 0x80 ? 2 : 0;
    };
    while (i < sentence.size()) {
        const int type = kind(i);
        std::size_t end = i + 1;
        while (end < sentence.size() && kind(end) == type)
            ++end;
        if (type != 0) {
            Word word{sentence.substr(i, end - i), i, end};
            for (char& character : word.text)
                character = static_cast<char>(std::tolower(static_cast<unsigned char>(character)));
            words.push_back(std::move(word));
        }
        i = end;
    }
    return words;
}

/// Angles from the camera's viewing direction, in degrees, clockwise as seen from above.
const std::map<std::string, float> viewer_words = {
    {"left", -90}, {"right", 90}, {"front", 180}, {"camera", 180},  {"viewer", 180},  {"behind", 0},
    {"back", 0},   {"rear", 0},   {"backlit", 0}, {"backlight", 0}, {"frontlit", 180}};

/// Angles from north, in degrees, clockwise.
const std::map<std::string, float> compass_words = {
    {"north", 0},      {"east", 90},       {"south", 180},     {"west", 270},
    {"northern", 0},   {"eastern", 90},    {"southern", 180},  {"western", 270},
    {"northeast", 45}, {"southeast", 135}, {"southwest", 225}, {"northwest", 315}};

const std::map<std::string, int> numbers = {
    {"one", 1},   {"two", 2},   {"three", 3}, {"four", 4}, {"five", 5},    {"six", 6},
    {"seven", 7}, {"eight", 8}, {"nine", 9},  {"ten", 10}, {"eleven", 11}, {"twelve", 12}};

const std::set<std::string> above_words = {"above", "overhead", "top", "upper", "zenith"};
const std::set<std::string> below_words = {"below", "underneath", "beneath", "bottom", "lower"};
const std::set<std::string> low_words = {"low", "rising", "setting"};
const std::set<std::string> high_words = {"high"};
/// Words that denote a direction anywhere. Other words do so only after a preposition, so that "a
/// left glove" has no direction.
const std::set<std::string> lone_words = {"behind",     "above",   "overhead", "below",
                                          "underneath", "beneath", "backlit",  "frontlit"};
const std::set<std::string> prepositions = {"from", "in", "at", "on", "to", "towards"};
/// Words that are ignored between words of direction.
const std::set<std::string> fillers = {
    "the", "a", "and",      "of",   "from",     "in", "at",  "on",   "to",  "side",  "hand", "your",
    "my",  "s", "straight", "just", "directly", "up", "far", "very", "sky", "model", "it",   "its"};
/// Words that may remain beside a direction without further meaning.
const std::set<std::string> empty_words = {
    "lit",    "light", "lighted", "illuminated", "sun", "sunlight", "lighting", "lamp",    "the",
    "a",      "is",    "it",      "with",        "by",  "and",      "coming",   "shining", "comes",
    "shines", "falls", "falling", "of",          "in",  "from",     "to",       "at",      "on"};

/// Accumulated directions of a sentence.
struct Said {
    float x = 0;  ///< east component of the sum of horizontal directions
    float z = 0;  ///< south component
    bool horizontal = false;
    bool only_camera = true;
    int vertical = 0;  ///< 1 for above, -1 for below
    std::optional<float> elevation;

    void add(float azimuth, bool is_camera = false) {
        const float angle = azimuth * pi / 180;
        x += std::sin(angle);
        z -= std::cos(angle);
        horizontal = true;
        only_camera = only_camera && is_camera;
    }
};

class Parser {
  public:
    Parser(std::string sentence, float viewer_azimuth)
        : sentence_(std::move(sentence)),
          ahead_(viewer_azimuth + 180),
          words_(words_of(sentence_)),
          used_(words_.size(), false) {}

    LightWords parse() {
        // A sentence of direction words only, such as "front left", answers the question "where
        // from?".
        const bool whole = says_nothing_else();
        for (std::size_t i = 0; i < words_.size();) {
            std::size_t length = 0;
            const bool begins = whole || prepositions.contains(words_[i].text) ||
                                lone_words.contains(words_[i].text) || is_clock(i) ||
                                (modifies(i) && said_.horizontal);
            if (begins) length = group(i);
            i += std::max<std::size_t>(length, 1);
        }
        take_leading_modifiers();
        return {direction(), rest()};
    }

  private:
    bool is(std::size_t i, const std::set<std::string>& set) const {
        return i < words_.size() && set.contains(words_[i].text);
    }
    bool modifies(std::size_t i) const { return is(i, low_words) || is(i, high_words); }
    int number_at(std::size_t i) const {
        if (i >= words_.size()) return -1;
        const std::string& text = words_[i].text;
        const auto found = numbers.find(text);
        if (found != numbers.end()) return found->second;
        if (text.size() > 3 || !std::isdigit(static_cast<unsigned char>(text[0]))) return -1;
        return std::stoi(text);
    }
    /// True for "2 o'clock", "two oclock".
    bool is_clock(std::size_t i) const {
        const int hour = number_at(i);
        if (hour < 1 || hour > 12) return false;
        return is(i + 1, {"oclock"}) || (is(i + 1, {"o"}) && is(i + 2, {"clock"}));
    }
    bool is_degrees(std::size_t i) const {
        return number_at(i) >= 0 && number_at(i) <= 90 && is(i + 1, {"degree", "degrees"});
    }

    /// Adds the direction that the words from `i` on denote to `said`. Returns the number of these
    /// words; 0 if there are none.
    std::size_t term(std::size_t i, Said& said) const {
        if (i >= words_.size()) return 0;
        const std::string& text = words_[i].text;
        if (is_clock(i)) {
            said.add(ahead_ + 30.0f * number_at(i));
            return is(i + 1, {"o"}) ? 3 : 2;
        }
        if (is_degrees(i)) {
            said.elevation = static_cast<float>(number_at(i));
            return is(i + 2, {"up", "high", "above"}) ? 3 : 2;
        }
        // A light behind the camera is in front of the model; "camera left" is left in the image.
        if (is(i, {"behind"})) {
            std::size_t next = i + 1;
            while (is(next, {"the", "your", "my", "of"}))
                ++next;
            if (is(next, {"camera", "viewer", "me", "us", "you"})) {
                said.add(ahead_ + 180, true);
                return next + 1 - i;
            }
        }
        if (is(i, {"camera"}) && is(i + 1, {"left", "right"})) {
            said.add(ahead_ + viewer_words.at(words_[i + 1].text));
            return 2;
        }
        if (const auto found = viewer_words.find(text); found != viewer_words.end()) {
            said.add(ahead_ + found->second, text == "camera" || text == "viewer");
            return 1;
        }
        if (const auto found = compass_words.find(text); found != compass_words.end()) {
            said.add(found->second);
            return 1;
        }
        if (is(i, above_words))
            said.vertical += 1;
        else if (is(i, below_words))
            said.vertical -= 1;
        else if (is(i, low_words))
            said.elevation = low_elevation;
        else if (is(i, high_words))
            said.elevation = high_elevation;
        else
            return 0;
        return 1;
    }

    bool says_nothing_else() const {
        Said ignored;
        bool any = false;
        for (std::size_t i = 0; i < words_.size();) {
            const std::size_t length = term(i, ignored);
            any = any || length > 0;
            if (length == 0 && !is(i, fillers) && !is(i, empty_words)) return false;
            i += std::max<std::size_t>(length, 1);
        }
        return any;
    }

    /// Takes words of direction from `begin` on, with fillers between them. Fillers at the end are
    /// not taken.
    std::size_t group(std::size_t begin) {
        Said said = said_;
        std::size_t end = begin;
        for (std::size_t i = begin; i < words_.size();) {
            const std::size_t length = term(i, said);
            if (length == 0 && !is(i, fillers) && !is(i, prepositions)) break;
            i += std::max<std::size_t>(length, 1);
            if (length > 0) end = i;
        }
        if (end == begin) return 0;
        // "side" and "sky" belong to the previous words: "the left side", "high in the sky".
        for (std::size_t i = end; is(i, fillers); ++i)
            if (is(i, {"side", "hand", "sky"})) end = i + 1;
        // "High" or "low" alone is no direction, as in "in high spirits".
        if (!said.horizontal && said.vertical == 0) return 0;
        said_ = said;
        std::fill(used_.begin() + static_cast<std::ptrdiff_t>(begin),
                  used_.begin() + static_cast<std::ptrdiff_t>(end), true);
        return end - begin;
    }

    /// Takes modifiers before the direction: "low sun in the east", "a sun low in the east".
    void take_leading_modifiers() {
        for (std::size_t i = 0; i < words_.size(); ++i) {
            if (used_[i] || !modifies(i) || !said_.horizontal) continue;
            std::size_t next = i + 1;
            while (is(next, {"sun", "light", "lamp", "moon"}))
                ++next;
            if (next >= words_.size() || !used_[next]) continue;
            term(i, said_);
            used_[i] = true;
        }
    }

    std::optional<SkyAngles> direction() const {
        const float length = std::hypot(said_.x, said_.z);
        if (said_.horizontal && length < 0.05f) return std::nullopt;
        SkyAngles angles;
        if (said_.horizontal) {
            angles.azimuth = to_sky_angles(Vec3(said_.x, 0, said_.z)).azimuth;
            angles.elevation = said_.elevation      ? *said_.elevation
                               : said_.vertical > 0 ? above_elevation
                               : said_.vertical < 0 ? below_elevation
                               : said_.only_camera  ? camera_elevation
                                                    : usual_elevation;
            return angles;
        }
        if (said_.vertical == 0) return std::nullopt;
        angles.elevation = said_.vertical > 0 ? 90 : -90;
        return angles;
    }

    std::string rest() const {
        bool says_something = false;
        for (std::size_t i = 0; i < words_.size(); ++i)
            says_something = says_something || (!used_[i] && !is(i, empty_words));
        if (!says_something) return "";
        // Removes the taken words, together with the text between them.
        std::string text = sentence_;
        for (std::size_t end = words_.size(); end > 0;) {
            if (!used_[end - 1]) {
                --end;
                continue;
            }
            std::size_t begin = end - 1;
            while (begin > 0 && used_[begin - 1])
                --begin;
            text.replace(words_[begin].begin, words_[end - 1].end - words_[begin].begin, "");
            end = begin;
        }
        std::string result;
        for (const char character : text) {
            const bool is_space = std::isspace(static_cast<unsigned char>(character));
            if (is_space && (result.empty() || result.back() == ' ')) continue;
            if (character == ',' && !result.empty() && result.back() == ' ') result.pop_back();
            result += is_space ? ' ' : character;
        }
        const char* const edges = " ,;.";
        const std::size_t first = result.find_first_not_of(edges);
        if (first == std::string::npos) return "";
        return result.substr(first, result.find_last_not_of(edges) - first + 1);
    }

    std::string sentence_;
    float ahead_;  ///< azimuth of the camera's viewing direction
    std::vector<Word> words_;
    std::vector<bool> used_;
    Said said_;
};

}  // namespace

LightWords parse_light_words(const std::string& sentence, float viewer_azimuth) {
    return Parser(sentence, viewer_azimuth).parse();
}

const std::vector<std::string>& light_words_help() {
    static const std::vector<std::string> lines = {
        "from the left, right, front, back (or behind), camera (or behind the camera)",
        "from above (or overhead, top, upper), below (or underneath, bottom, lower)",
        "in the north, east, south, west, northeast, ...",
        "from 2 o'clock, from two o'clock: 6 is the camera, 12 beyond the model",
        "low or rising or setting, high, 40 degrees up: together with one of the others",
        "combinations: from the front right, from above left, low in the south east",
    };
    return lines;
}

}  // namespace item3d
