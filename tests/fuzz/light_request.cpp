#include "item3d/studio/light_request.h"

#include "tests/fuzz/fuzz.h"

#include <map>
#include <sstream>

/// Reads the parameters of a light's address. Each line has a name and a value, such as "sun
/// 120,30". A sky takes a hundred times as long as a preset, so few inputs get one.
ITEM3D_FUZZ_TARGET(light_request, data, size) {
    using namespace item3d;
    std::map<std::string, std::string> values;
    std::istringstream lines(fuzz::as_text(data, size));
    for (std::string line; std::getline(lines, line);)
        if (const auto space = line.find(' '); space != std::string::npos)
            values[line.substr(0, space)] = line.substr(space + 1);
    return fuzz::read_or_refuse([&] {
        requested_light(
            values.contains("hour") && size % 32 == 0 ? "sky" : "overcast", 16,
            [&](const std::string& name) { return values[name]; }, "");
    });
}
