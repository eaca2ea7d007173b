// Which view comes next.
#pragma once

#include "item3d/core/random.h"

#include <cstdint>
#include <numeric>
#include <vector>

namespace item3d {

/// All views in a random order, then all in another, and so on: a function of seed and iteration.
class ViewOrder {
  public:
    ViewOrder(std::size_t views, std::uint64_t seed) : order_(views), seed_(seed) {}

    std::size_t at(std::int64_t iteration) {
        const auto count = static_cast<std::int64_t>(order_.size());
        const std::int64_t round = iteration / count;
        if (round != round_) shuffle(round);
        return order_[static_cast<std::size_t>(iteration % count)];
    }

  private:
    void shuffle(std::int64_t round) {
        Random random(seed_, 0x76696577, static_cast<std::uint64_t>(round) << 32);
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        for (std::size_t i = order_.size(); i > 1; --i)
            std::swap(order_[i - 1],
                      order_[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(i)))]);
        round_ = round;
    }

    std::vector<std::size_t> order_;
    std::uint64_t seed_;
    std::int64_t round_ = -1;
};

}  // namespace item3d
