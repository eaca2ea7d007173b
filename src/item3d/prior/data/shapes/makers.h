// Shared helpers of the files of shape themes (animals.h, food.h, ...), each of which returns its
// classes.
#pragma once

#include "item3d/core/random.h"
#include "item3d/prior/data/shapes/lathe.h"
#include "item3d/prior/data/shapes/shapes.h"

#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Random numbers of a variant.
class Draw {
  public:
    explicit Draw(Random random) : random_(random) {}
    float operator()(double low, double high) {
        return static_cast<float>(random_.uniform(low, high));
    }
    int pick(int count) { return static_cast<int>(random_.index(count)); }

  private:
    Random random_;
};

struct ShapeMaker {
    ShapeClass shape;
    Shape (*make)(Draw&);
};

/// Returns a shape with a single part.
inline Shape whole(SignedDistance distance) {
    return {{{"", std::move(distance)}}};
}

inline SignedDistance turned(const Lathe& lathe) {
    return [lathe](const Vec3& p) { return lathe.distance(p); };
}

}  // namespace item3d
