#include "item3d/prior/data/shapes/noise.h"

namespace item3d {
namespace {

/// Approximates cos(2 pi turns) to 1e-3. The standard library's cosine would take most of the time
/// of drawing training data.
inline float cosine_of_turns(float turns) {
    const float shifted = turns + (turns < 0 ? -.5f : .5f);
    const float t = turns - static_cast<float>(static_cast<int>(shifted));  // [-1/2, 1/2]
    const float x = .25f - (t < 0 ? -t : t);  // cos(2 pi t) = sin(2 pi x)
    const float x2 = x * x;
    return x * (6.2831853f + x2 * (-41.338f + x2 * (81.34f - 71.6f * x2)));
}

}  // namespace

CosineNoise::CosineNoise(Random& random, float frequency, int octaves, const Vec3& stretch) {
    float amplitude = 1.0f, energy = 0.0f;
    for (int i = 0; i < octaves; ++i) {
        Octave octave;
        for (std::size_t k = 0; k < waves; ++k) {
            Vec3 direction{random.normal(), random.normal(), random.normal()};
            direction = direction / (glm::length(direction) + 1e-9f) * stretch * frequency *
                        static_cast<float>(random.uniform(.6, 1.4)) / (2 * pi);
            octave.x[k] = direction.x;
            octave.y[k] = direction.y;
            octave.z[k] = direction.z;
            octave.phase[k] = static_cast<float>(random.uniform());
        }
        octave.amplitude = amplitude * std::sqrt(2.0f / waves);
        octaves_.push_back(octave);
        energy += amplitude * amplitude;
        amplitude *= .5f;
        frequency *= 2.1f;
    }
    for (Octave& octave : octaves_)
        octave.amplitude /= std::sqrt(energy);
}

float CosineNoise::operator()(const Vec3& p) const {
    float sum = 0;
    for (const Octave& octave : octaves_) {
        std::array<float, waves> wave;
        for (std::size_t k = 0; k < waves; ++k) {
            wave[k] = cosine_of_turns(p.x * octave.x[k] + p.y * octave.y[k] + p.z * octave.z[k] +
                                      octave.phase[k]);
        }
        float octave_sum = 0;
        for (const float value : wave)
            octave_sum += value;
        sum += octave.amplitude * octave_sum;
    }
    return sum;
}

float CosineNoise::with_gradient(const Vec3& p, Vec3& gradient) const {
    float sum = 0;
    for (const Octave& octave : octaves_) {
        for (std::size_t k = 0; k < waves; ++k) {
            const Vec3 wave(octave.x[k], octave.y[k], octave.z[k]);
            const float turns = glm::dot(p, wave) + octave.phase[k];
            sum += octave.amplitude * cosine_of_turns(turns);
            // -sin(t) = cos(t + a quarter turn)
            gradient += 2 * pi * octave.amplitude * cosine_of_turns(turns + .25f) * wave;
        }
    }
    return sum;
}

}  // namespace item3d
