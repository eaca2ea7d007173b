#include "item3d/region/space_selectors.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

namespace item3d {
namespace {

at::Tensor row(Vec3 v) {
    return at::tensor({v.x, v.y, v.z});
}

class BoxSelector : public Selector {
  public:
    BoxSelector(Vec3 low, Vec3 high) : low_(row(low)), high_(row(high)) {}
    at::Tensor weight(const Surface& surface) const override {
        const at::Tensor position = surface.position.detach().cpu();
        return position.ge(low_).logical_and(position.le(high_)).all(1).to(at::kFloat);
    }

  private:
    at::Tensor low_, high_;
};

class SphereSelector : public Selector {
  public:
    SphereSelector(Vec3 centre, float radius) : centre_(row(centre)), radius_(radius) {}
    at::Tensor weight(const Surface& surface) const override {
        const at::Tensor apart = surface.position.detach().cpu() - centre_;
        return apart.square().sum(1).le(radius_ * radius_).to(at::kFloat);
    }

  private:
    at::Tensor centre_;
    float radius_;
};

void check_overlap(const SelectorText& text, const Model& model, Vec3 low, Vec3 high) {
    const auto [model_low, model_high] = model.bounds();
    const Vec3 origin(model.origin);
    for (int c = 0; c < 3; ++c) {
        if (low[c] <= model_high[c] && high[c] >= model_low[c]) continue;
        const Vec3 a = model_low + origin, b = model_high + origin;
        throw InputError(
            text.whole, "is outside the model",
            fmt::format("the model is between {:.4g},{:.4g},{:.4g} and {:.4g},{:.4g},{:.4g}", a.x,
                        a.y, a.z, b.x, b.y, b.z));
    }
}

}  // namespace

std::unique_ptr<Selector> select_box(const SelectorText& text, const RegionScene& scene) {
    const std::vector<float> n = numbers_of(text, 6);
    const Vec3 origin(scene.model.origin);
    const Vec3 a = Vec3(n[0], n[1], n[2]) - origin, b = Vec3(n[3], n[4], n[5]) - origin;
    check_overlap(text, scene.model, glm::min(a, b), glm::max(a, b));
    return std::make_unique<BoxSelector>(glm::min(a, b), glm::max(a, b));
}

std::unique_ptr<Selector> select_sphere(const SelectorText& text, const RegionScene& scene) {
    const std::vector<float> n = numbers_of(text, 4);
    if (!(n[3] > 0))
        throw InputError(text.whole, "the radius must be above 0", "as in " + text.form);
    const Vec3 centre = Vec3(n[0], n[1], n[2]) - Vec3(scene.model.origin);
    check_overlap(text, scene.model, centre - n[3], centre + n[3]);
    return std::make_unique<SphereSelector>(centre, n[3]);
}

}  // namespace item3d
