#include "item3d/baselines/view_lists.h"

#include <algorithm>

namespace item3d {

const std::vector<ViewAngles>& ring_and_poles() {
    static const std::vector<ViewAngles> views = {{0, 30},   {45, 30},  {315, 30}, {90, 30},
                                                  {270, 30}, {135, 30}, {225, 30}, {180, 30},
                                                  {180, 60}, {180, -60}};
    return views;
}

const std::vector<ViewAngles>& principal_views() {
    static const std::vector<ViewAngles> views = {{0, 15},   {45, 15},  {315, 15}, {90, 15},
                                                  {270, 15}, {135, 15}, {225, 15}, {180, 15},
                                                  {0, 89},   {0, -89}};
    return views;
}

const std::vector<ViewAngles>& candidate_views() {
    static const std::vector<ViewAngles> views = [] {
        std::vector<ViewAngles> all;
        for (const float elevation : {0.0f, 30.0f, -30.0f})
            for (int i = 0; i < 12; ++i)
                all.push_back({30.0f * static_cast<float>(i), elevation});
        return all;
    }();
    return views;
}

const std::vector<ViewAngles>& synchronized_views() {
    static const std::vector<ViewAngles> views = [] {
        std::vector<ViewAngles> all;
        for (int i = 0; i < 8; ++i)
            all.push_back({45.0f * static_cast<float>(i), 0});
        all.push_back({0, 60});
        all.push_back({180, 60});
        return all;
    }();
    return views;
}

std::vector<ViewAngles> first_views(const std::vector<ViewAngles>& views, int count) {
    const auto wanted = static_cast<std::size_t>(std::max(0, count));
    if (count == 0 || wanted >= views.size()) return views;
    return {views.begin(), views.begin() + static_cast<std::ptrdiff_t>(wanted)};
}

}  // namespace item3d
