#include "item3d/lighting/presets/sky_model.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/sun_disk.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace item3d {

namespace {

using Double3 = glm::dvec3;

// Lengths are in kilometres. Coefficients are for 680, 550 and 440 nm (from Bruneton and Neyret
// 2008; those of ozone from Hillaire 2020).
constexpr double ground_radius = 6360.0;
constexpr double top_radius = 6460.0;
constexpr double observer_radius = ground_radius + 0.05;
const Double3 rayleigh_scattering(5.802e-3, 13.558e-3, 33.1e-3);
constexpr double rayleigh_height = 8.0;
constexpr double mie_scattering = 3.996e-3;
constexpr double mie_extinction = 4.44e-3;
constexpr double mie_height = 1.2;
constexpr double mie_asymmetry = 0.8;
const Double3 ozone_absorption(0.650e-3, 1.881e-3, 0.085e-3);
constexpr double ozone_centre = 25.0;
constexpr double ozone_half_width = 15.0;

/// Largest change of the cosine of the sun's zenith angle along the observer's longest ray (1100
/// km), over which the zenith turns by 10 degrees.
constexpr double mu_sun_reach = 0.2;

/// Scattering and extinction of air, per kilometre.
struct Medium {
    Double3 rayleigh;
    double mie;
    Double3 extinction;
};

Medium medium_at(double radius, double haze) {
    const double altitude = std::max(0.0, radius - ground_radius);
    Medium medium;
    medium.rayleigh = rayleigh_scattering * std::exp(-altitude / rayleigh_height);
    const double aerosol = haze * std::exp(-altitude / mie_height);
    medium.mie = mie_scattering * aerosol;
    const double ozone = std::max(0.0, 1.0 - std::abs(altitude - ozone_centre) / ozone_half_width);
    medium.extinction = medium.rayleigh + mie_extinction * aerosol + ozone_absorption * ozone;
    return medium;
}

double rayleigh_phase(double cosine) {
    return 3.0 / (16.0 * M_PI) * (1.0 + cosine * cosine);
}

/// Mie phase function of Cornette and Shanks 1992.
double mie_phase(double cosine) {
    const double g = mie_asymmetry;
    const double base = 1.0 + g * g - 2.0 * g * cosine;
    return 3.0 / (8.0 * M_PI) * (1.0 - g * g) * (1.0 + cosine * cosine) /
           ((2.0 + g * g) * base * std::sqrt(base));
}

/// Returns the distance to the sphere of radius `sphere` from inside or outside along a ray that
/// starts at distance `radius` from the planet's centre with cosine `mu` to the zenith. The result
/// is negative if the ray misses the sphere.
double distance_to_sphere(double radius, double mu, double sphere, bool far_side) {
    const double discriminant = radius * radius * (mu * mu - 1.0) + sphere * sphere;
    if (discriminant < 0) return -1;
    return -radius * mu + (far_side ? 1 : -1) * std::sqrt(discriminant);
}

bool hits_ground(double radius, double mu) {
    return mu < 0 && radius * radius * (mu * mu - 1.0) + ground_radius * ground_radius >= 0;
}

double radius_along(double radius, double mu, double distance) {
    return std::sqrt(distance * distance + 2.0 * radius * mu * distance + radius * radius);
}

/// A table over [0, 1]^2 with bilinear interpolation. Its samples include the borders.
class Table {
  public:
    Table(int width, int height)
        : width_(width), height_(height), values_(static_cast<std::size_t>(width) * height) {}
    int width() const { return width_; }
    int height() const { return height_; }
    Double3& at(int x, int y) { return values_[static_cast<std::size_t>(y) * width_ + x]; }
    const Double3& at(int x, int y) const {
        return values_[static_cast<std::size_t>(y) * width_ + x];
    }
    Double3 lookup(double x, double y) const {
        x = std::clamp(x, 0.0, 1.0) * (width_ - 1);
        y = std::clamp(y, 0.0, 1.0) * (height_ - 1);
        const int x0 = std::min(static_cast<int>(x), width_ - 2);
        const int y0 = std::min(static_cast<int>(y), height_ - 2);
        const Double3 low = glm::mix(at(x0, y0), at(x0 + 1, y0), x - x0);
        const Double3 high = glm::mix(at(x0, y0 + 1), at(x0 + 1, y0 + 1), x - x0);
        return glm::mix(low, high, y - y0);
    }

  private:
    int width_;
    int height_;
    std::vector<Double3> values_;
};

/// Bruneton and Neyret's parametrisation of the transmittance table (their section 4). Samples
/// concentrate at the horizon, where the transmittance changes fastest.
const double horizon_span = std::sqrt(top_radius * top_radius - ground_radius * ground_radius);

double height_parameter(double radius) {
    return std::sqrt(std::max(0.0, radius * radius - ground_radius * ground_radius)) / horizon_span;
}

class Atmosphere {
  public:
    explicit Atmosphere(const SkyOptions& options)
        : haze_(options.haze),
          sun_radius_(options.sun_radius),
          ground_albedo_(options.ground_albedo),
          mu_sun_(options.sun_direction.y),
          transmittance_(128, 48),
          multiple_(9, 32) {
        fill_transmittance();
        fill_multiple_scattering();
    }

    /// Returns the transmittance from a point to the top of the atmosphere, for rays that miss the
    /// ground.
    Double3 transmittance(double radius, double mu) const {
        const double rho = height_parameter(radius) * horizon_span;
        const double distance = std::max(0.0, distance_to_sphere(radius, mu, top_radius, true));
        const double shortest = top_radius - radius;
        const double longest = rho + horizon_span;
        return transmittance_.lookup((distance - shortest) / std::max(longest - shortest, 1e-9),
                                     rho / horizon_span);
    }

    /// Returns the transmittance towards the sun, times the visible part of its disk above the
    /// ground.
    Double3 sun_transmittance(double radius, double mu) const {
        const double sine = ground_radius / radius;
        const double horizon = -std::sqrt(std::max(0.0, 1.0 - sine * sine));
        const double margin = sine * std::min(0.01, sun_radius_);
        const double visible = std::clamp((mu - horizon + margin) / (2 * margin), 0.0, 1.0);
        if (visible == 0) return Double3(0);
        return visible * visible * (3 - 2 * visible) *
               transmittance(radius, std::max(mu, horizon + 1e-6));
    }

    struct Ray {
        Double3 radiance{0};       ///< radiance relative to the sun's irradiance
        Double3 transmittance{1};  ///< transmittance of the whole ray
        Double3 isotropic{0};      ///< scattered radiance if radiance 1 comes from all directions
    };

    /// Integrates along a ray up to the ground or the top. cosine: cosine of the angle between ray
    /// and sun. mu_sun: cosine of the sun's zenith angle at the ray's start.
    Ray integrate(double radius, double mu, double mu_sun, double cosine, int steps,
                  bool single_only) const {
        const bool ground = hits_ground(radius, mu);
        const double length = ground ? distance_to_sphere(radius, mu, ground_radius, false)
                                     : distance_to_sphere(radius, mu, top_radius, true);
        const double phase_r = single_only ? 1 / (4 * M_PI) : rayleigh_phase(cosine);
        const double phase_m = single_only ? 1 / (4 * M_PI) : mie_phase(cosine);
        Ray ray;
        double start = 0;
        for (int step = 0; step < steps; ++step) {
            // Steps grow with distance: the air near the observer is densest.
            const double end = length * std::pow((step + 1.0) / steps, 2.0);
            const double delta = end - start;
            const double middle = 0.5 * (start + end);
            start = end;
            const double r = radius_along(radius, mu, middle);
            const double sun = std::clamp((radius * mu_sun + middle * cosine) / r, -1.0, 1.0);
            const Medium medium = medium_at(r, haze_);
            const Double3 scattering = medium.rayleigh + medium.mie;
            Double3 source = sun_transmittance(r, sun) *
                             (medium.rayleigh * phase_r + Double3(medium.mie * phase_m));
            if (!single_only) source += scattering * multiple(r, sun);
            const Double3 passed = glm::exp(-medium.extinction * delta);
            const Double3 weight = ray.transmittance * (1.0 - passed) / medium.extinction;
            ray.radiance += weight * source;
            ray.isotropic += weight * scattering;
            ray.transmittance *= passed;
        }
        if (ground && single_only) {
            const double sun = (radius * mu_sun + length * cosine) / ground_radius;
            ray.radiance += ray.transmittance * sun_transmittance(ground_radius, sun) *
                            std::max(0.0, sun) * ground_albedo_ / M_PI;
        }
        return ray;
    }

  private:
    Double3 multiple(double radius, double mu_sun) const {
        return multiple_.lookup((mu_sun - mu_sun_) / (2 * mu_sun_reach) + 0.5,
                                height_parameter(radius));
    }

    void fill_transmittance() {
        parallel_for(
            "sky transmittance", static_cast<std::int64_t>(transmittance_.height()),
            [&](std::int64_t row) {
                const double rho = horizon_span * row / (transmittance_.height() - 1);
                const double radius = std::sqrt(rho * rho + ground_radius * ground_radius);
                const double shortest = top_radius - radius;
                for (int column = 0; column < transmittance_.width(); ++column) {
                    const double x = static_cast<double>(column) / (transmittance_.width() - 1);
                    const double length = shortest + x * (rho + horizon_span - shortest);
                    const double mu = length <= 0 ? 1.0
                                                  : std::clamp((top_radius * top_radius -
                                                                radius * radius - length * length) /
                                                                   (2 * radius * length),
                                                               -1.0, 1.0);
                    constexpr int steps = 64;
                    Double3 depth(0);
                    for (int step = 0; step < steps; ++step) {
                        const double distance = length * (step + 0.5) / steps;
                        depth += medium_at(radius_along(radius, mu, distance), haze_).extinction;
                    }
                    transmittance_.at(column, static_cast<int>(row)) =
                        glm::exp(-depth * (length / steps));
                }
            },
            1);
    }

    /// Computes Hillaire 2020, section 5.5: the second order from all directions around a point,
    /// and the geometric series of all further orders.
    void fill_multiple_scattering() {
        constexpr int directions = 8;
        parallel_for(
            "sky multiple scattering", static_cast<std::int64_t>(multiple_.height()),
            [&](std::int64_t row) {
                const double rho = horizon_span * row / (multiple_.height() - 1);
                const double radius = std::min(
                    std::sqrt(rho * rho + ground_radius * ground_radius) + 1e-3, top_radius - 1e-3);
                for (int column = 0; column < multiple_.width(); ++column) {
                    const double part = static_cast<double>(column) / (multiple_.width() - 1);
                    const double mu_sun =
                        std::clamp(mu_sun_ + (2 * part - 1) * mu_sun_reach, -1.0, 1.0);
                    const double sine_sun = std::sqrt(std::max(0.0, 1 - mu_sun * mu_sun));
                    Double3 second(0);
                    Double3 again(0);
                    for (int i = 0; i < directions * directions; ++i) {
                        const double mu = 2.0 * (i / directions + 0.5) / directions - 1.0;
                        const double angle = 2 * M_PI * (i % directions + 0.5) / directions;
                        const double cosine =
                            mu * mu_sun + std::sqrt(1 - mu * mu) * sine_sun * std::cos(angle);
                        const Ray ray = integrate(radius, mu, mu_sun, cosine, 20, true);
                        second += ray.radiance;
                        again += ray.isotropic;
                    }
                    const double each = 1.0 / (directions * directions);
                    multiple_.at(column, static_cast<int>(row)) =
                        second * each / (1.0 - again * each);
                }
            },
            1);
    }

    double haze_;
    double sun_radius_;
    Double3 ground_albedo_;
    double mu_sun_;  ///< cosine of the sun's zenith angle at the observer
    Table transmittance_;
    Table multiple_;
};

}  // namespace

Image make_clear_sky(const SkyOptions& options, int height) {
    ITEM3D_CHECK(height >= 2, "a sky needs two rows");
    const int width = 2 * height;
    const Atmosphere atmosphere(options);
    const Double3 sun(options.sun_direction);
    const Double3 above(options.sun_irradiance);
    Image image(width, height, 3);

    parallel_for(
        "sky", (height + 1) / 2,
        [&](std::int64_t row) {
            for (int x = 0; x < width; ++x) {
                const Double3 direction(equirectangular_direction(
                    (x + 0.5f) / static_cast<float>(width),
                    (static_cast<float>(row) + 0.5f) / static_cast<float>(height)));
                const Atmosphere::Ray ray =
                    atmosphere.integrate(observer_radius, std::max(direction.y, 1e-4), sun.y,
                                         glm::dot(direction, sun), 48, false);
                for (int c = 0; c < 3; ++c) {
                    image.at(x, static_cast<int>(row), c) =
                        static_cast<float>(above[c] * ray.radiance[c]);
                }
            }
        },
        1);
    if (sun.y > 0) {
        add_sun_disk(image, {options.sun_direction, options.sun_radius,
                             above * atmosphere.sun_transmittance(observer_radius, sun.y)});
    }

    Double3 irradiance(0);
    for (int y = 0; y < height / 2; ++y) {
        const double weight = texel_solid_angle(y, height) * std::cos(M_PI * (y + 0.5) / height);
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c)
                irradiance[c] += weight * image.at(x, y, c);
        }
    }
    const Double3 ground = irradiance * Double3(options.ground_albedo) / M_PI;
    for (int y = (height + 1) / 2; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = static_cast<float>(ground[c]);
        }
    }
    return image;
}

}  // namespace item3d
