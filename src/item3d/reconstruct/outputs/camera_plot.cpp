#include "item3d/reconstruct/outputs/camera_plot.h"

#include "item3d/core/format.h"

#include <algorithm>

namespace item3d {

namespace {

constexpr float plot_size = 360;

/// Orthographic drawing. `across` and `up` are the world directions of its axes.
class Drawing {
  public:
    Drawing(Vec3 centre, float reach, Vec3 across, Vec3 up)
        : centre_(centre), scale_(0.46f * plot_size / reach), across_(across), up_(up) {}

    Vec2 place(Vec3 point) const {
        const Vec3 p = point - centre_;
        return Vec2(0.5f * plot_size + scale_ * glm::dot(p, across_),
                    0.5f * plot_size - scale_ * glm::dot(p, up_));
    }
    std::string camera(const Camera& camera, bool held_out, float length) const {
        const Vec2 eye = place(camera.position());
        const Vec2 ahead = place(camera.position() - length * Vec3(camera.camera_to_world[2]));
        return fmt::format(
            "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#999\"/>"
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\" stroke=\"#35618f\"/>",
            eye.x, eye.y, ahead.x, ahead.y, eye.x, eye.y, held_out ? "none" : "#35618f");
    }
    std::string box(std::array<Vec3, 2> bounds) const {
        const Vec2 a = place(bounds[0]), b = place(bounds[1]);
        const Vec2 low = glm::min(a, b), size = glm::abs(b - a);
        return fmt::format(
            "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
            "fill=\"#d9b48f\" stroke=\"#8a5a2b\"/>",
            low.x, low.y, size.x, size.y);
    }

  private:
    Vec3 centre_;
    float scale_;
    Vec3 across_, up_;
};

}  // namespace

std::string camera_plot(const Dataset& dataset, std::array<Vec3, 2> bounds) {
    const Vec3 centre = 0.5f * (bounds[0] + bounds[1]);
    float reach = 0.5f * glm::length(bounds[1] - bounds[0]);
    for (const auto* views : {&dataset.train, &dataset.test})
        for (const Photograph& view : *views)
            reach = std::max(reach, glm::distance(view.camera.position(), centre));
    const std::array drawings{Drawing(centre, reach, Vec3(1, 0, 0), Vec3(0, 0, -1)),
                              Drawing(centre, reach, Vec3(1, 0, 0), Vec3(0, 1, 0))};
    const std::array captions{"From above (+X right, -Z up)", "From the front (+X right, +Y up)"};
    std::string html = "<div class=\"charts\">\n";
    for (std::size_t i = 0; i < drawings.size(); ++i) {
        html += fmt::format("<figure><svg viewBox=\"0 0 {0} {0}\" width=\"{0}\" height=\"{0}\">",
                            plot_size);
        html += drawings[i].box(bounds);
        for (const Photograph& view : dataset.train)
            html += drawings[i].camera(view.camera, false, 0.15f * reach);
        for (const Photograph& view : dataset.test)
            html += drawings[i].camera(view.camera, true, 0.15f * reach);
        html += fmt::format("</svg><figcaption>{}</figcaption></figure>\n", captions[i]);
    }
    return html + "</div>\n";
}

}  // namespace item3d
