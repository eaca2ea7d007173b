// Which pictures' outlines do not belong to the others.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <cstddef>
#include <vector>

namespace item3d {

/// How well outlines agree, told from the rays of some of the object's pixels. A ray contradicts
/// the other views when each place on it lies plainly outside the outline of one of them.
struct Contradictions {
    double share = 0;          ///< of rays that contradict, with all views
    double share_of_rest = 0;  ///< the same without `views`
    /// Views without which the others agree, worst first. Empty also where no few views are it.
    std::vector<std::size_t> views;
    bool unsolved = false;  ///< they contradict each other, and no few views explain it
};

/// The views, at most about 256 pixels a side, with two channels: the mean coverage of the pixels
/// that each stands for, and their largest.
std::vector<Photograph> small_masks(const std::vector<Photograph>& views);

/// What a view does not show it says nothing about. Places are those of a lattice within 1.2 radii
/// of `centre`, outlines wider by more than its cells: thin parts between its points and inexact
/// poses do no harm. masks: of small_masks().
Contradictions find_contradictions(const std::vector<Photograph>& masks, Vec3 centre, float radius);

/// The share of rays without a place that all views allow and half of them show: small where poses
/// and pictures belong together, and not where views have nothing to say about each other.
double unsupported_share(const std::vector<Photograph>& masks, Vec3 centre, float radius);

}  // namespace item3d
