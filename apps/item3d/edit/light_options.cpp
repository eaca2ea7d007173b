#include "apps/item3d/edit/light_options.h"

#include "apps/item3d/edit/image_options.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/layout.h"
#include "item3d/lighting/words.h"
#include "item3d/metrics/color.h"
#include "item3d/report/display_image.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

namespace item3d {

namespace {

/// Parses "a,b,c". Returns no value if a part is not a finite number.
std::optional<std::vector<float>> parse_numbers(const std::string& text) {
    std::vector<float> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (true) {
        float value = 0;
        const auto result = std::from_chars(at, end, value);
        if (result.ec != std::errc() || !std::isfinite(value)) return std::nullopt;
        numbers.push_back(value);
        if (result.ptr == end) return numbers;
        if (*result.ptr != ',') return std::nullopt;
        at = result.ptr + 1;
    }
}

SunSetting parse_sun(const std::string& text) {
    const auto numbers = parse_numbers(text);
    if (!numbers || numbers->size() < 2 || numbers->size() > 3 || std::abs((*numbers)[0]) > 36000 ||
        std::abs((*numbers)[1]) > 90 ||
        (numbers->size() == 3 && ((*numbers)[2] <= 0 || (*numbers)[2] > 1e6f))) {
        throw UsageError("--sun " + text +
                         ": expected AZIMUTH,ELEVATION[,STRENGTH] with an elevation from -90 to 90 "
                         "and a strength above 0, as in 120,35");
    }
    SunSetting sun;
    sun.from = {(*numbers)[0], (*numbers)[1]};
    if (numbers->size() == 3) sun.strength = (*numbers)[2];
    return sun;
}

SunSetting parse_lit(const std::string& sentence) {
    // Azimuths of cameras are measured from +Z towards +X, azimuths of the compass from -Z.
    const LightWords words = parse_light_words(sentence, 180 - default_azimuth * 180 / pi);
    if (!words.from) {
        throw InputError("--lit '" + sentence + "'", "contains no direction of light",
                         fmt::format("{}", fmt::join(light_words_help(), "; ")));
    }
    if (!words.rest.empty()) {
        warn("--lit: '" + words.rest + "' is not a direction and is ignored");
    }
    SunSetting sun;
    sun.from = *words.from;
    return sun;
}

Vec3 linear_tint(const std::string& text) {
    const Vec3 color = parse_color(text);
    return Vec3(srgb_to_linear(color.x), srgb_to_linear(color.y), srgb_to_linear(color.z));
}

nlohmann::json angles_json(Vec3 direction) {
    const SkyAngles angles = to_sky_angles(direction);
    return {{"azimuth", angles.azimuth}, {"elevation", angles.elevation}};
}

/// Returns the number, or null.
nlohmann::json number_or_null(const std::optional<double>& number) {
    return number ? nlohmann::json(*number) : nlohmann::json();
}

}  // namespace

CLI::Validator number_between(float low, float high) {
    return {[=](std::string& text) {
                const auto numbers = parse_numbers(text);
                const bool fits = numbers && numbers->size() == 1 && numbers->front() >= low &&
                                  numbers->front() <= high;
                return fits ? std::string()
                            : fmt::format("expected a number from {} to {}, found {}", low, high,
                                          text);
            },
            fmt::format("[{} - {}]", low, high)};
}

void add_light_options(CLI::App& command, LightOptions& options) {
    const char* const group = "Changes to the light, in this order";
    command
        .add_option("--layout", options.layout,
                    "Layout of a light file; auto: from its aspect ratio")
        ->check(CLI::IsMember(light_layout_names()))
        ->capture_default_str()
        ->group("Reading the light");
    command
        .add_option("--rotate", options.rotation, "Rotation about +Y, from north (-Z) to east (+X)")
        ->type_name("DEGREES")
        ->check(number_between(-36000.0f, 36000.0f))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--tilt", options.tilt, "Tilt about the west-east axis, which raises the north")
        ->type_name("DEGREES")
        ->check(number_between(-36000.0f, 36000.0f))
        ->capture_default_str()
        ->group(group);
    CLI::Option* sun =
        command
            .add_option(
                "--sun", options.sun,
                "Move the light's sun, or add one: AZIMUTH,ELEVATION[,STRENGTH], in degrees; "
                "azimuth 0 is north, 90 east. STRENGTH is the sun's irradiance relative to the "
                "mean of the rest. Default: that of the light's sun, else 6")
            ->group(group);
    command
        .add_option(
            "--lit", options.lit,
            fmt::format("Direction of the sun in words: {}. Left and right are as seen by the "
                        "viewer, at {:.0f} degrees azimuth",
                        fmt::join(light_words_help(), "; "), 180 - default_azimuth * 180 / pi))
        ->excludes(sun)
        ->group(group);
    command.add_option("--strength", options.strength, "Strength of --lit")
        ->check(number_between(1e-3f, 1e6f))
        ->excludes(sun)
        ->group(group);
    command
        .add_option("--sun-width", options.sun_width,
                    "Angular diameter of the sun; the real sun has 0.53")
        ->type_name("DEGREES")
        ->check(number_between(0.53f, 30.0f))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--tint", options.tint,
                    "Colour, scaled to luminance 1, that multiplies the light: a name or #rrggbb")
        ->type_name("COLOUR")
        ->group(group);
    command
        .add_option("--exposure", options.exposure, "Exposure: the light is multiplied by 2^STOPS")
        ->type_name("STOPS")
        ->check(number_between(-30.0f, 30.0f))
        ->capture_default_str()
        ->group(group);
}

std::optional<SunSetting> chosen_sun(const LightOptions& options) {
    if (options.sun.empty() && options.lit.empty()) {
        if (options.strength) throw UsageError("--strength requires --lit");
        return std::nullopt;
    }
    SunSetting sun = options.sun.empty() ? parse_lit(options.lit) : parse_sun(options.sun);
    if (options.strength) sun.strength = options.strength;
    sun.width = options.sun_width;
    return sun;
}

Image apply(const LightOptions& options, const std::optional<SunSetting>& sun, const Image& light) {
    LightChange change{options.rotation, options.tilt, options.exposure, sun, std::nullopt};
    if (!options.tint.empty()) change.tint = linear_tint(options.tint);
    return change_light(light, change);
}

nlohmann::json settings_json(const LightOptions& options, const std::optional<SunSetting>& sun) {
    nlohmann::json settings = {{"layout", options.layout},
                               {"rotate", options.rotation},
                               {"tilt", options.tilt},
                               {"sun", nullptr},
                               {"lit", nullptr},
                               {"tint", nullptr},
                               {"exposure", options.exposure}};
    if (!options.lit.empty()) settings["lit"] = options.lit;
    if (!options.tint.empty()) settings["tint"] = options.tint;
    if (sun) {
        settings["sun"] = {{"azimuth", sun->from.azimuth},
                           {"elevation", sun->from.elevation},
                           {"width", sun->width},
                           {"strength", nullptr}};
        if (sun->strength) settings["sun"]["strength"] = *sun->strength;
    }
    return settings;
}

nlohmann::json to_json(const LightDescription& description) {
    const LightLobe& lobe = description.lobe;
    nlohmann::json dominant = angles_json(description.dominant_direction);
    dominant["directionality"] = description.directionality;
    nlohmann::json brightest = angles_json(lobe.direction);
    brightest["width"] = 2 * lobe.radius() * 180 / M_PI;
    brightest["share"] = lobe.share;
    brightest["is_sun"] = lobe.is_sun();
    const glm::dvec3 mean = description.mean_radiance;
    return {{"dominant", dominant},
            {"brightest_lobe", brightest},
            {"mean_radiance", luminance(mean)},
            {"mean_radiance_rgb", {mean.x, mean.y, mean.z}},
            {"color_temperature", number_or_null(description.color_temperature)},
            {"dynamic_range_stops", number_or_null(description.dynamic_range)},
            {"peak_irradiance_over_pi", description.peak_irradiance_over_pi}};
}

std::string to_text(const LightDescription& description) {
    const SkyAngles dominant = to_sky_angles(description.dominant_direction);
    const LightLobe& lobe = description.lobe;
    const SkyAngles brightest = to_sky_angles(lobe.direction);
    std::string text = fmt::format(
        "dominant direction  azimuth {:.1f}, elevation {:.1f} degrees (directionality {:.2f})\n",
        dominant.azimuth, dominant.elevation, description.directionality);
    text += fmt::format(
        "brightest lobe      azimuth {:.1f}, elevation {:.1f}, {:.1f} degrees wide, {:.1f} % of "
        "the "
        "energy{}\n",
        brightest.azimuth, brightest.elevation, 2 * lobe.radius() * 180 / M_PI, 100 * lobe.share,
        lobe.is_sun() ? ": a sun" : "");
    text += fmt::format("mean radiance       {:.4g}\n", luminance(description.mean_radiance));
    text += description.color_temperature
                ? fmt::format("colour temperature  {:.0f} K\n", *description.color_temperature)
                : "colour temperature  none: not close to white\n";
    text += description.dynamic_range
                ? fmt::format("dynamic range       {:.1f} stops\n", *description.dynamic_range)
                : "dynamic range       unbounded: parts of the light are black\n";
    return text;
}

Image light_image(const Image& light, int width) {
    // The median of the non-black pixels becomes a middle grey.
    std::vector<float> values;
    for (std::size_t i = 1; i < light.pixels.size(); i += 3)
        if (light.pixels[i] > 0) values.push_back(light.pixels[i]);
    float scale = 1;
    if (!values.empty()) {
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        scale = 0.25f / *middle;
    }
    Image exposed = light;
    for (float& value : exposed.pixels)
        value = std::min(1.0f, value * scale);
    const int height = std::max(1, width * light.height / light.width);
    return to_display(resize(exposed, width, height));
}

}  // namespace item3d
