#include "item3d/reconstruct/dataset/check_views.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parallel.h"
#include "item3d/reconstruct/dataset/contradictions.h"
#include "item3d/reconstruct/dataset/orient_world.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace item3d {

namespace {

constexpr float clipped_value = 0.999f, above_clipping = 1.01f, black_value = 0.002f;
constexpr double many_pixels = 0.2, max_pixels = 0.5, nearly_all_pixels = 0.9;
/// Maximum fraction of contradicting rays that inexact masks cause.
constexpr double harmless_share = 0.02;
constexpr std::size_t names_listed = 3;

/// Statistics of the object's pixels in an image.
struct ObjectPixels {
    double object = 0;   ///< number of pixels that the object covers
    double clipped = 0;  ///< number of object pixels with a clipped channel
    double lost = 0;     ///< number of object pixels with two or more clipped channels
    double black = 0;
    double covered = 0;           ///< number of pixels with any coverage
    double half_transparent = 0;  ///< number of pixels with partial coverage away from outlines
    bool is_unbounded = false;    ///< true if some pixel is brighter than white
};

/// True if no nearby pixel is free of the object, so that partial coverage is no outline.
bool is_within(const Image& image, int x, int y, int reach) {
    if (x < reach || y < reach || x + reach >= image.width || y + reach >= image.height)
        return false;
    for (int v = y - reach; v <= y + reach; ++v)
        for (int u = x - reach; u <= x + reach; ++u)
            if (image.at(u, v, 3) <= 0.1f) return false;
    return true;
}

ObjectPixels look_at_pixels(const Image& image) {
    ObjectPixels pixels;
    const int reach = std::max(2, std::max(image.width, image.height) / 100);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const float alpha = image.at(x, y, 3);
            if (alpha <= 0.1f) continue;
            ++pixels.covered;
            if (alpha < 0.9f) {
                pixels.half_transparent += is_within(image, x, y, reach);
                continue;
            }
            ++pixels.object;
            std::array<float, 3> color;
            for (int c = 0; c < 3; ++c)
                color[c] = image.at(x, y, c) / alpha;
            std::sort(color.begin(), color.end());
            pixels.clipped += color[2] >= clipped_value;
            pixels.lost += color[1] >= clipped_value;
            pixels.black += color[2] <= black_value;
            pixels.is_unbounded = pixels.is_unbounded || color[2] > above_clipping;
        }
    }
    return pixels;
}

/// Mean of a fraction over all views, and the number of views whose fraction exceeds a limit.
struct ShareOfViews {
    double mean = 0;
    std::size_t above = 0;
};

ShareOfViews share_of_views(const std::vector<ObjectPixels>& views, double ObjectPixels::*part,
                            double ObjectPixels::*whole, double limit) {
    ShareOfViews share;
    double parts = 0, wholes = 0;
    for (const ObjectPixels& view : views) {
        parts += view.*part;
        wholes += view.*whole;
        share.above += view.*part > limit * view.*whole;
    }
    share.mean = wholes > 0 ? parts / wholes : 0.0;
    return share;
}

void check_brightness(const std::vector<ObjectPixels>& views, const std::string& subject,
                      std::vector<std::string>& warnings) {
    const bool is_unbounded = std::any_of(views.begin(), views.end(),
                                          [](const ObjectPixels& v) { return v.is_unbounded; });
    const std::size_t maximum = views.size() / 2;
    if (!is_unbounded) {  // in unbounded images 1 is an ordinary brightness
        const ShareOfViews lost =
            share_of_views(views, &ObjectPixels::lost, &ObjectPixels::object, max_pixels);
        if (lost.above > maximum) {
            throw InputError(
                subject,
                fmt::format(
                    "{} of {} images are overexposed: {:.0f} % of the object's pixels are clipped",
                    lost.above, views.size(), 100 * lost.mean),
                "use a shorter exposure");
        }
        const ShareOfViews clipped =
            share_of_views(views, &ObjectPixels::clipped, &ObjectPixels::object, max_pixels);
        if (clipped.mean > many_pixels) {
            warnings.push_back(
                fmt::format("{:.0f} % of the object's pixels are clipped, so light and materials "
                            "are uncertain there; use a shorter exposure",
                            100 * clipped.mean));
        }
    }
    const ShareOfViews black =
        share_of_views(views, &ObjectPixels::black, &ObjectPixels::object, nearly_all_pixels);
    if (black.above > maximum) {
        throw InputError(
            subject,
            fmt::format("{} of {} images show a black object: {:.0f} % of its pixels are black",
                        black.above, views.size(), 100 * black.mean),
            "use a longer exposure");
    }
    if (black.mean > max_pixels) {
        warnings.push_back(
            fmt::format("{:.0f} % of the object's pixels are black and cannot be reconstructed; "
                        "use a longer exposure",
                        100 * black.mean));
    }
}

/// Correction of a mistake common to all images or poses.
struct Remedy {
    const char* problem;
    const char* hint;
    bool flip_x, flip_y;
    std::function<Mat4(const Mat4&)> pose;
};

Image flipped(const Image& image, bool flip_x, bool flip_y) {
    Image result = image;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < image.channels; ++c)
                result.at(x, y, c) = image.at(flip_x ? image.width - 1 - x : x,
                                              flip_y ? image.height - 1 - y : y, c);
    return result;
}

/// Throws InputError if one correction of all views makes the outlines consistent.
void look_for_remedy(const std::vector<Photograph>& masks, const Dataset& dataset, double share,
                     const std::string& subject) {
    const Mat4 world(dataset.world_from_dataset), back = glm::transpose(world);
    const Mat4 other_axes(1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1);
    const auto same = [](const Mat4& pose) { return pose; };
    const auto inverse = [&](const Mat4& pose) { return world * glm::inverse(back * pose); };
    const std::vector<Remedy> remedies{
        {"the images look mirrored", "flip all images left to right", true, false, same},
        {"the images look mirrored", "flip all images top to bottom", false, true, same},
        {"the images look upside down", "rotate all images by 180 degrees", true, true, same},
        {"the cameras look along +z",
         "negate the second and third column of each matrix, so that y is up", false, false,
         [&](const Mat4& pose) { return pose * other_axes; }},
        {"the poses look inverted", "give camera-to-world matrices", false, false, inverse},
        {"the poses look inverted, and along +z",
         "give camera-to-world matrices of cameras that look along -z", false, false,
         [&](const Mat4& pose) { return inverse(pose) * other_axes; }}};
    for (const Remedy& remedy : remedies) {
        std::vector<Photograph> changed = masks;
        for (Photograph& view : changed) {
            if (remedy.flip_x || remedy.flip_y)
                view.image = flipped(view.image, remedy.flip_x, remedy.flip_y);
            view.camera.camera_to_world = remedy.pose(view.camera.camera_to_world);
        }
        const auto [centre, radius] = region_seen(changed);
        const double after = unsupported_share(changed, centre, radius);
        if (after > std::min(harmless_share, 0.2 * share)) continue;
        throw InputError(subject,
                         fmt::format("{}: {:.0f} % of the object's pixels contradict other images, "
                                     "{:.0f} % after the correction",
                                     remedy.problem, 100 * share, 100 * after),
                         remedy.hint);
    }
}

std::string names_of(const std::vector<Photograph>& views, const std::vector<std::size_t>& which) {
    std::string text;
    for (std::size_t i = 0; i < std::min(names_listed, which.size()); ++i)
        text += (i > 0 ? ", '" : "'") + views[which[i]].name + "'";
    return text + (which.size() > names_listed ? ", ..." : "");
}

void check_outlines(const Dataset& dataset, const std::string& subject, ViewProblems& problems) {
    const std::vector<Photograph> masks = small_masks(dataset.train);
    const Contradictions found = find_contradictions(masks, dataset.centre, dataset.radius);
    if (found.views.empty() && !found.unsolved) return;
    const std::size_t count = dataset.train.size();
    if (found.unsolved || 10 * found.views.size() > count)
        look_for_remedy(masks, dataset, found.share, subject);
    // If the images of the model spot are shuffled at random, they contradict each other in 0.55 of
    // their pixels.
    constexpr double hopeless = 0.5;
    if (found.share > hopeless)
        throw InputError(
            subject,
            fmt::format("the images contradict each other in {:.0f} % of the object's pixels",
                        100 * found.share),
            "check that each pose belongs to its image, and that masks show the object in white");
    if (found.unsolved) {
        problems.warnings.push_back(
            fmt::format("the images contradict each other in {:.0f} % of the object's pixels: the "
                        "object moved, or poses, lens or masks are wrong",
                        100 * found.share));
        return;
    }
    const std::size_t wrong = found.views.size();
    problems.contradicting = found.views;
    problems.warnings.push_back(fmt::format(
        "{} of {} images {} the others and {} left out: {}; {}", wrong, count,
        wrong == 1 ? "contradicts" : "contradict", wrong == 1 ? "is" : "are",
        names_of(dataset.train, found.views),
        wrong > std::max<std::size_t>(names_listed, count / 20)
            ? "the object moved between the images, or their poses or masks are wrong"
            : (wrong == 1 ? "its pose or mask is wrong" : "their poses or masks are wrong")));
}

}  // namespace

ViewProblems check_views(const Dataset& dataset, const std::string& subject) {
    ViewProblems problems;
    std::vector<ObjectPixels> pixels(dataset.train.size());
    parallel_for(
        "look_at_pixels", static_cast<std::int64_t>(pixels.size()),
        [&](std::int64_t i) {
            const auto index = static_cast<std::size_t>(i);
            pixels[index] = look_at_pixels(dataset.train[index].image);
        },
        1);
    check_brightness(pixels, subject, problems.warnings);
    const ShareOfViews glass = share_of_views(pixels, &ObjectPixels::half_transparent,
                                              &ObjectPixels::covered, many_pixels);
    if (glass.mean > many_pixels) {
        problems.warnings.push_back(
            fmt::format("{:.0f} % of the masked area is semi-transparent, which is not supported "
                        "and becomes either opaque or empty",
                        100 * glass.mean));
    }
    check_outlines(dataset, subject, problems);
    return problems;
}

}  // namespace item3d
