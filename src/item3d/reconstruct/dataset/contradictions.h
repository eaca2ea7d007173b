// Detection of views whose outlines contradict the others.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <cstddef>
#include <vector>

namespace item3d {

/// Consistency of outlines, from rays through some of the object's pixels. A ray contradicts the
/// other views if every point on it is clearly outside the outline of at least one of them.
struct Contradictions {
    double share = 0;          ///< fraction of contradicting rays, over all views
    double share_of_rest = 0;  ///< the same without `views`
    /// Views without which the others are consistent, worst first. Empty if there is no small set
    /// of such views.
    std::vector<std::size_t> views;
    /// True if the views contradict each other and no small set of views is the cause.
    bool unsolved = false;
};

/// Returns the views, at most about 256 pixels along a side, with two channels: mean and maximum
/// coverage of the pixels that each one covers.
std::vector<Photograph> small_masks(const std::vector<Photograph>& views);

/// Finds contradicting views. A view gives no evidence on points outside its image. Points are
/// those of a lattice within 1.2 radii of `centre`, outlines are widened by more than its cells:
/// thin parts between points and inexact poses do no harm. masks: of small_masks().
Contradictions find_contradictions(const std::vector<Photograph>& masks, Vec3 centre, float radius);

/// Returns the fraction of rays without a point that all views allow and half of them show: small
/// if poses and images match, and large if views share no evidence.
double unsupported_share(const std::vector<Photograph>& masks, Vec3 centre, float radius);

}  // namespace item3d
