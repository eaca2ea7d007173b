// Detection of views whose outlines contradict those of other views.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <cstddef>
#include <vector>

namespace item3d {

/// Consistency of outlines, from rays through some of the object's pixels. A ray contradicts the
/// other views if every point on it is clearly outside the outline of at least one other view.
struct Contradictions {
    double share = 0;          ///< fraction of contradicting rays, over all views
    double share_of_rest = 0;  ///< `share` after `views` are left out
    /// Views that must be left out so that the remaining views are consistent, worst first. Empty
    /// if no small set of views achieves this.
    std::vector<std::size_t> views;
    /// True if the views contradict each other and no small set of views is the cause.
    bool unsolved = false;
};

/// Returns the views with images shrunk to at most about 256 pixels along a side. The images have
/// two channels: the mean and the maximum of the coverage of the original pixels within each pixel.
std::vector<Photograph> small_masks(const std::vector<Photograph>& views);

/// Finds contradicting views. The points on rays are taken from a lattice within 1.2 radii of
/// `centre`. A view never contradicts points outside its image. Outlines are widened by more than a
/// cell of the lattice, so that thin parts between lattice points and slightly inexact poses cause
/// no contradiction. masks: result of small_masks().
Contradictions find_contradictions(const std::vector<Photograph>& masks, Vec3 centre, float radius);

/// Returns the fraction of rays that have no point which all views allow and half of the views
/// show. It is small if poses and images match, and large if the views show no common points.
double unsupported_share(const std::vector<Photograph>& masks, Vec3 centre, float radius);

}  // namespace item3d
